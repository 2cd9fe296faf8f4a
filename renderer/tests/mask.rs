//! `penumbra mask`: depth buffers of another program against its own truth, and what is refused.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use test_models::skipped;

fn mask(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_penumbra"));
    command.current_dir(folder).arg("mask").args(arguments);
    command.output().expect("the program runs")
}

fn refused(folder: &Path, arguments: &[&str], reason: &str) {
    let output = mask(folder, arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert_eq!(message.lines().count(), 1, "{message}");
    assert!(message.contains(reason), "`{message}` does not say `{reason}`");
    assert!(!folder.join("mask.npy").exists(), "nothing half-written");
}

/// An .npy file of floats.
fn npy(shape: &str, values: &[f32]) -> Vec<u8> {
    let mut header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({shape}), }}");
    while (header.len() + 11) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((header.len() as u16).to_le_bytes());
    file.extend(header.as_bytes());
    file.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    file
}

fn floats(path: &Path) -> Vec<f32> {
    let file = fs::read(path).unwrap();
    let header = usize::from(u16::from_le_bytes([file[8], file[9]]));
    file[10 + header..].as_chunks::<4>().0.iter().map(|&b| f32::from_le_bytes(b)).collect()
}

const VIEWS: &str = r#"{"depth": "linear",
  "camera": {"projection": [[1,0,0,0],[0,1,0,0],[0,0,-1,-0.1],[0,0,-1,0]],
             "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,-4,1]},
  "light": {"projection": [[1,0,0,0],[0,1,0,0],[0,0,-1,-0.1],[0,0,-1,0]],
            "view": [1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,-4,1]}}"#;

/// A wall 4 m away, and in front of its right half, seen by the light only, a board at 2 m.
fn wall() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let light: Vec<f32> = (0..64 * 64).map(|i| if i % 64 < 32 { 4.0 } else { 2.0 }).collect();
    fs::write(folder.path().join("camera.npy"), npy("64, 64", &[4.0; 64 * 64])).unwrap();
    fs::write(folder.path().join("light.npy"), npy("64, 64", &light)).unwrap();
    fs::write(folder.path().join("views.json"), VIEWS).unwrap();
    folder
}

const BUFFERS: [&str; 4] = ["--camera-depth", "camera.npy", "--light-depth", "light.npy"];

fn with<'a>(views: &'a str, more: &[&'a str]) -> Vec<&'a str> {
    [&[views][..], &BUFFERS, more].concat()
}

#[test]
fn a_board_in_front_of_a_wall_shades_half_of_it() {
    let folder = wall();
    let arguments = with("views.json", &["--radius", "0.5", "-o", "mask.npy"]);
    let output = mask(folder.path(), &arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mask = floats(&folder.path().join("mask.npy"));
    // The penumbra's radius: 32 texels per tangent, times 0.5 m, times 1/2 - 1/4.
    // The board ends where the map does: beyond, nothing is known, so look at its inner half.
    let row = &mask[32 * 64..][..48];
    assert_eq!((row[22], row[42]), (1.0, 0.0), "{row:?}");
    // Groups of pixels that end beyond the penumbra are interpolated within 1/50.
    assert!(row[27] >= 1.0 - 1.0 / 64.0 && row[36] <= 1.0 / 64.0, "{row:?}");
    assert!((row[31] + row[32] - 1.0).abs() < 0.02, "both sides of the edge: {row:?}");
    assert!(row.windows(2).all(|pair| pair[1] <= pair[0]), "monotone: {row:?}");
}

#[test]
fn every_kind_of_file_holds_the_mask() {
    let folder = wall();
    for (name, more) in [
        ("mask.png", &[][..]),
        ("mask.png", &["--png", "16"]),
        ("mask.png", &["--png", "catcher"]),
        ("mask.exr", &[]),
        ("mask.pfm", &[]),
    ] {
        let more = [&["--radius", "0.5", "-o", name], more].concat();
        let output = mask(folder.path(), &with("views.json", &more));
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        assert!(fs::metadata(folder.path().join(name)).unwrap().len() > 0);
    }
}

#[test]
fn what_cannot_be_is_refused() {
    let folder = wall();
    let folder = folder.path();
    let out = ["--radius", "0.5", "-o", "mask.npy"];
    refused(folder, &with("missing.json", &out), "missing.json");
    refused(folder, &with("views.json", &["-o", "mask.npy"]), "--radius");
    refused(folder, &with("views.json", &["--angle", "1", "-o", "mask.npy"]), "--radius");
    refused(folder, &with("views.json", &["--radius", "nan", "-o", "mask.npy"]), "number");
    for (views, reason) in [
        (VIEWS.replace("\"linear\"", "\"metric\""), "metric"),
        (VIEWS.replace("\"depth\": \"linear\",", ""), "say what depth means"),
        (VIEWS.replace("\"projection\"", "\"clip_from_world\""), "view from world"),
        (VIEWS.replace("[0,0,-1,0]]", "[0,0,0,0]]"), "not that of a camera"),
        (VIEWS.replace("0,0,-4,1", "0,0,-4000,1"), "lies in the light's map"),
        (VIEWS.replace("\"linear\"", "\"opengl\""), "there is nothing in it"),
        ("{".to_owned(), "broken.json"),
    ] {
        // The same view twice always agrees: move one.
        let views = if reason.starts_with("lies") {
            VIEWS.replacen("0,0,-4,1", "4000,0,-4,1", 1)
        } else {
            views
        };
        fs::write(folder.join("broken.json"), views).unwrap();
        refused(folder, &with("broken.json", &out), reason);
    }
    let whole = npy("64, 64", &[4.0; 64 * 64]);
    for (file, reason) in [
        (npy("64, 65", &[4.0; 64 * 64]), "4160 numbers"),
        (npy("64, 64, 2", &[4.0; 64 * 128]), "2 numbers per pixel"),
        (npy("99999999, 99999999", &[]), "a side must be"),
        (npy("0, 64", &[]), "a side must be"),
        (npy("64", &[4.0; 64]), "shape"),
        (whole[..5000].to_vec(), "numbers"),
        (whole[..40].to_vec(), "light.npy"),
        (b"\x93NUMPY\x02\x00\xff\xff\xff\xff".to_vec(), "header"),
        (Vec::new(), "no .npy file"),
    ] {
        fs::write(folder.join("light.npy"), file).unwrap();
        refused(folder, &with("views.json", &out), reason);
    }
}

/// A Python that has what `tests/foreign/render.py` needs.
fn python() -> Option<PathBuf> {
    let asked = std::env::var("PENUMBRA_PYTHON").unwrap_or_else(|_| "python3".into());
    let modules = ["-c", "import numpy, trimesh, embreex"];
    let output = Command::new(&asked).args(modules).output().ok()?;
    output.status.success().then(|| asked.into())
}

#[test]
fn depth_of_another_ray_tracer_gives_its_own_truth() {
    let Some(python) = python() else {
        return skipped("no Python with numpy, trimesh and embreex (PENUMBRA_PYTHON)");
    };
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/foreign/render.py");
    let drawn = Command::new(python).arg(script).arg(folder).output().unwrap();
    assert!(drawn.status.success(), "{}", String::from_utf8_lossy(&drawn.stderr));
    let truth = floats(&folder.join("truth.npy"));
    let ids = ["--camera-ids", "camera-ids.npy", "--radius", "0.5", "-o", "mask.npy"];
    let normals = ["--camera-normals", "camera-normals.npy"];
    // Without normals, silhouette pixels a facet wide have no plane to derive.
    for (more, limit) in [(&normals[..], 0.016), (&[], 0.055)] {
        let output = mask(folder, &with("views.json", &[&ids, more].concat()));
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let mask = floats(&folder.join("mask.npy"));
        let penumbra = || truth.iter().zip(&mask).filter(|(t, _)| (0.002..0.998).contains(*t));
        let squares: f64 = penumbra().map(|(t, m)| f64::from(t - m).powi(2)).sum();
        let rmse = (squares / penumbra().count() as f64).sqrt();
        println!("penumbra RMSE with {} normals: {rmse:.4}", more.len() / 2);
        assert!(rmse < limit, "{rmse}");
    }
}
