//! Material files.

use glam::{Vec3, Vec4};

use super::text::{Line, lines, number, words};
use crate::scene::{AlphaMode, Material};

/// A material and the file of its texture.
pub(super) struct MtlMaterial {
    pub(super) material: Material,
    pub(super) texture: Option<String>,
}

/// Reads the materials of a file. Lines that make no sense are passed over: the colours of a
/// model are not worth refusing it.
pub(super) fn read(text: &str) -> Vec<MtlMaterial> {
    let mut materials: Vec<MtlMaterial> = Vec::new();
    for Line { keyword, rest, .. } in lines(text) {
        if keyword == "newmtl" {
            let material = Material { name: rest.to_owned(), ..Material::default() };
            materials.push(MtlMaterial { material, texture: None });
            continue;
        }
        let Some(MtlMaterial { material, texture }) = materials.last_mut() else { continue };
        match keyword {
            "Kd" => {
                if let Some(color) = color(rest) {
                    let color = color.clamp(Vec3::ZERO, Vec3::ONE);
                    material.base_color = color.extend(material.base_color.w);
                }
            }
            "Ke" => {
                if let Some(color) = color(rest) {
                    material.emissive = color.clamp(Vec3::ZERO, Vec3::splat(1e9));
                }
            }
            "d" => set_alpha(material, scalar(rest)),
            "Tr" => set_alpha(material, scalar(rest).map(|t| 1.0 - t)),
            "map_Kd" => *texture = texture_file(rest),
            // With a texture for it, the alpha of the picture counts; as holes, which is what
            // leaves and fences mean by it.
            "map_d" => material.alpha_mode = AlphaMode::Mask(0.5),
            _ => {}
        }
    }
    for MtlMaterial { material, texture } in &mut materials {
        // Exporters write black beside a texture.
        if texture.is_some() && material.base_color.truncate() == Vec3::ZERO {
            material.base_color = Vec3::ONE.extend(material.base_color.w);
        }
    }
    materials
}

fn scalar(rest: &str) -> Option<f32> {
    number(words(rest).next()?).filter(|x| x.is_finite())
}

fn color(rest: &str) -> Option<Vec3> {
    let mut numbers = words(rest).map_while(number);
    let red = numbers.next()?;
    // One number means grey.
    let [green, blue] = [numbers.next().unwrap_or(red), numbers.next().unwrap_or(red)];
    Some(Vec3::new(red, green, blue)).filter(|c| c.is_finite())
}

fn set_alpha(material: &mut Material, alpha: Option<f32>) {
    let Some(alpha) = alpha.map(|a| a.clamp(0.0, 1.0)) else { return };
    material.base_color = Vec4::from((material.base_color.truncate(), alpha));
    material.alpha_mode = if alpha < 1.0 { AlphaMode::Blend } else { AlphaMode::Opaque };
}

/// The file of a `map_` statement, behind its options.
fn texture_file(rest: &str) -> Option<String> {
    let mut rest = rest.trim();
    while rest.starts_with('-') {
        let (option, mut after) = rest.split_once(char::is_whitespace)?;
        let most = match option {
            "-o" | "-s" | "-t" => 3,
            "-mm" => 2,
            _ => 1,
        };
        for taken in 0..most {
            let Some((word, further)) = after.trim_start().split_once(char::is_whitespace) else {
                break;
            };
            // -o, -s and -t take one to three numbers.
            if taken > 0 && number(word).is_none() {
                break;
            }
            after = further;
        }
        rest = after.trim_start();
    }
    (!rest.is_empty()).then(|| rest.replace('\\', "/"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn materials_of_a_file() {
        let text = "Kd 1 0 0\nnewmtl a b\n Kd 0.5 0.25\t0.125 # c\nKd 0.5x\nd 0.5\nKe 2\n\
                    newmtl c\nKd 0 0 0\nmap_Kd -s 1 1 1 -clamp on dir\\a b.png\nTr nan\nfoo\n\
                    newmtl e\nmap_Kd -o 1 x.png\nmap_d x.png\nd\n";
        let [a, c, e] = &read(text)[..] else { panic!() };
        assert_eq!(a.material.name, "a b");
        assert_eq!(a.material.base_color, Vec4::new(0.5, 0.25, 0.125, 0.5));
        assert_eq!(a.material.alpha_mode, AlphaMode::Blend);
        assert_eq!(a.material.emissive, Vec3::splat(2.0));
        assert_eq!(c.texture.as_deref(), Some("dir/a b.png"));
        assert_eq!(c.material.base_color, Vec4::ONE);
        assert_eq!(e.texture.as_deref(), Some("x.png"));
        assert_eq!(e.material.alpha_mode, AlphaMode::Mask(0.5));
    }

    #[test]
    fn no_text_is_too_broken() {
        let words =
            ["newmtl", "Kd", "map_Kd", "-s", "-mm", "Tr", "d", "1", "nan", "1e39", "\n", "x"];
        let mut state = 1_u64;
        for _ in 0..20_000 {
            let mut text = "newmtl x\n".to_owned();
            for _ in 0..12 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                text += words[(state >> 33) as usize % words.len()];
                text += if state >> 63 == 0 { " " } else { "\n" };
            }
            for MtlMaterial { material, .. } in read(&text) {
                assert!(material.base_color.is_finite() && material.emissive.is_finite());
            }
        }
    }
}
