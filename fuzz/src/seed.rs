//! Starts the corpora with the seeds and the regressions of all checks.

use std::fs;
use std::io::Result;
use std::path::Path;

fn main() -> Result<()> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    for check in hostile::CHECKS {
        let corpus = here.join("corpus").join(check.name);
        fs::create_dir_all(&corpus)?;
        for (i, seed) in (check.seeds)().iter().enumerate() {
            fs::write(corpus.join(format!("seed{i}")), seed)?;
        }
        let regressions = here.join("../tests/hostile/regressions").join(check.name);
        for file in fs::read_dir(regressions).into_iter().flatten() {
            let file = file?;
            fs::copy(file.path(), corpus.join(file.file_name()))?;
        }
    }
    Ok(())
}
