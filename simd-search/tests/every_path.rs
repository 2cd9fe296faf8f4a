//! Every path finds the texel that the definition names, with the same bits.

mod common;

use common::{KINDS, Random, check_all_paths, query, say_levels, texels};

#[test]
fn random_maps_and_queries() {
    say_levels("random maps and queries");
    for seed in 0..400 {
        let mut random = Random(seed);
        let (width, height) = match random.below(4) {
            0 => (1 + random.below(20), 1 + random.below(20)),
            1 => (1 + random.below(300), 1 + random.below(12)),
            _ => (1 + random.below(100), 1 + random.below(60)),
        };
        let texels = texels(seed as u32 % KINDS, width, height, &mut random);
        let queries: Vec<_> = (0..12).map(|_| query(&texels, &mut random)).collect();
        check_all_paths(&texels, &queries, random.below(3) == 0);
    }
}
