//! The program as scripts rely on it: exit codes, messages, files.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use renderer::picture::{Values, read};
use serde_json::Value;
use shadowmap_core::Level;

/// Bytes that a picture may take.
const MOST: u64 = 1 << 30;

/// Runs the program in `folder`, which is where relative paths lead.
fn penumbra(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_penumbra"));
    command.current_dir(folder).args(arguments).output().unwrap()
}

/// Runs it and expects success.
fn done(folder: &Path, arguments: &[&str]) -> Output {
    let output = penumbra(folder, arguments);
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {message}");
    assert_eq!(message, "", "{arguments:?}");
    output
}

#[test]
fn bad_values_end_in_one_line_and_leave_nothing() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("text.glb"), "no model").unwrap();
    for (arguments, words) in [
        (vec!["no-such-scene"], "no-such-scene: no built-in scene"),
        (vec!["absent.glb"], "absent.glb: "),
        (vec!["text.glb"], "text.glb: "),
        (vec!["torus", "--size", "0x10"], "--size 0x10: "),
        (vec!["torus", "--size", "99999x10"], "--size 99999x10: "),
        (vec!["torus", "--aa", "17"], "--aa 17: "),
        (vec!["torus", "--eye", "nan,0,0"], "--eye nan,0,0: "),
        (vec!["torus", "--eye", "0,0.8,0"], "--eye 0,0.8,0: the camera stands at its target"),
        (vec!["torus", "--fov", "-3"], "--fov -3: "),
        (vec!["torus", "--light", "sphere:0,0,0:-1"], "--light sphere:0,0,0:-1: "),
        (vec!["torus", "--light", "lava:1,2,3"], "--light lava:1,2,3: "),
        (vec!["torus", "--method", "magic"], "--method magic: no such method"),
        (vec!["torus", "--light", "linear:0,4,0:1,4,0", "--method", "pcss"], "linear light"),
        (vec!["torus", "--map-size", "0"], "--map-size 0: "),
        (vec!["torus", "--samples", "0"], "--samples 0: "),
        (vec!["torus", "--method", "skins", "--samples", "1"], "--samples 1: "),
        (vec!["torus", "--method", "hard", "--pass", "visibility-channel"], "only --method skins"),
        (vec!["torus", "--simd", "mmx"], "--simd mmx: no such level; there are auto, scalar"),
        (vec!["torus", "--threads", "0"], "--threads 0: "),
        (vec!["torus", "--pass", "smell"], "--pass smell: no such pass"),
        (vec!["torus", "--size", "16384x2", "--aa", "2"], "--size 16384x2 --aa 2: a side times 2"),
        (vec!["torus", "--size", "16384x16384", "--max-memory", "4000"], "--max-memory"),
        (vec!["torus", "-o", "picture.gif"], "picture.gif: "),
        (vec!["torus", "-o", "absent/picture.png"], "absent/picture.png: there is no folder"),
        (vec!["torus", "-o", "."], "--output .: "),
        (vec!["torus", "--stats", "absent/stats.json"], "absent/stats.json: "),
        (
            vec!["torus", "-o", "a.png", "--stats", "./a.png"],
            "--stats ./a.png: the output goes there",
        ),
        (
            vec![
                "torus",
                "--light",
                "sphere:0,4,0:1",
                "--light-fov",
                "60",
                "--light-target",
                "0,4,0",
            ],
            "--light-target 0,4,0: a light is there",
        ),
        (
            vec![
                "torus",
                "--light",
                "linear:0,4,0:1,4,0",
                "--light-fov",
                "60",
                "--light-target",
                "3,4,0",
            ],
            "--light-target 3,4,0: a light is there or points there",
        ),
    ] {
        let arguments: Vec<_> = std::iter::once("render").chain(arguments).collect();
        let output = penumbra(folder.path(), &arguments);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {message}");
        assert!(message.contains(words), "{arguments:?}: {message}");
        assert_eq!(message.matches('\n').count(), 1, "{arguments:?}: {message}");
        assert!(output.stdout.is_empty(), "{arguments:?}");
        let left: Vec<_> = fs::read_dir(&folder).unwrap().map(|e| e.unwrap().file_name()).collect();
        assert_eq!(left, ["text.glb"], "{arguments:?}");
    }
}

#[test]
fn levels_of_other_machines_are_named_as_missing() {
    let folder = tempfile::tempdir().unwrap();
    let absent = if cfg!(target_arch = "x86_64") { "neon" } else { "avx2" };
    let output = penumbra(folder.path(), &["render", "torus", "--simd", absent]);
    let message = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(message.contains("this machine lacks it; there are auto, scalar"), "{message}");
}

#[test]
fn wrong_usage_is_exit_code_2() {
    let folder = tempfile::tempdir().unwrap();
    for arguments in [
        &["render", "--no-such-option"][..],
        &["paint"],
        &[],
        &["render", "torus", "--light-fov", "60"],
        &["compare", "only-one.png"],
    ] {
        assert_eq!(penumbra(folder.path(), arguments).status.code(), Some(2), "{arguments:?}");
    }
    for arguments in
        [&["--help"][..], &["render", "--help"], &["compare", "--help"], &["mask", "--help"]]
    {
        let output = penumbra(folder.path(), arguments);
        assert_eq!(output.status.code(), Some(0));
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(text.contains("Usage"));
        // Where a line of ours is too long, the rest of it stands alone in the next one.
        for line in text.lines().filter(|line| !line.is_empty() && !line.starts_with(' ')) {
            assert!(line.contains(' ') || line.ends_with(':'), "{arguments:?}: {line}");
        }
    }
}

#[test]
fn a_failed_run_keeps_the_old_picture() {
    let folder = tempfile::tempdir().unwrap();
    let picture = folder.path().join("penumbra.png");
    fs::write(&picture, "old").unwrap();
    let failed = penumbra(folder.path(), &["render", "absent.obj"]);
    assert_eq!(failed.status.code(), Some(1));
    assert_eq!(fs::read(&picture).unwrap(), b"old");
    done(folder.path(), &["render", "blocker", "--size", "16x16", "--map-size", "16"]);
    assert!(fs::read(&picture).unwrap().starts_with(b"\x89PNG"));
}

#[test]
fn statistics_hold_every_repetition() {
    let folder = tempfile::tempdir().unwrap();
    done(
        folder.path(),
        &[
            "render",
            "torus",
            "--size",
            "64x48",
            "--map-size",
            "128",
            "--method",
            "hard",
            "--repeat",
            "3",
            "--threads",
            "1",
            "--simd",
            "scalar",
            "--stats",
            "stats.json",
        ],
    );
    let stats: Value =
        serde_json::from_slice(&fs::read(folder.path().join("stats.json")).unwrap()).unwrap();
    assert_eq!(stats["scene"], "torus");
    assert_eq!(stats["triangles"], 4098);
    assert_eq!(stats["size"], serde_json::json!([64, 48]));
    assert_eq!(stats["map_size"], 128);
    assert_eq!(stats["method"], "hard");
    assert_eq!(stats["samples"], 1);
    assert_eq!(stats["simd"], "scalar");
    assert_eq!(stats["threads"], 1);
    assert_eq!(stats["repeat"], 3);
    assert!(stats["version"].is_string());
    assert!(stats["counters"]["receivers"].as_u64().unwrap() > 0);
    for stage in
        ["load", "camera_pass", "light_maps", "visibility_channel", "shadow", "shade", "total"]
    {
        let times = stats["ms"][stage].as_array().unwrap();
        assert_eq!(times.len(), 3, "{stage}");
        assert!(times.iter().all(|time| time.as_f64().unwrap() >= 0.0), "{stage}");
    }
    let parts = ["camera_pass", "light_maps", "visibility_channel", "shadow", "shade"];
    let sum: f64 = parts.iter().map(|stage| stats["ms"][stage][1].as_f64().unwrap()).sum();
    assert!(stats["ms"]["total"][1].as_f64().unwrap() >= sum);
}

#[test]
fn threads_and_levels_never_change_a_byte() {
    let folder = tempfile::tempdir().unwrap();
    let picture = |name: &str, more: &[&str]| {
        let mut arguments = vec!["render", "torus", "--size", "96x80", "--map-size", "128"];
        arguments.extend(["-o", name]);
        arguments.extend(more);
        done(folder.path(), &arguments);
        fs::read(folder.path().join(name)).unwrap()
    };
    for (name, more) in [
        ("paper.png", &["--method", "search-paper", "--aa", "2"][..]),
        ("search.pfm", &["--method", "search", "--pass", "visibility"]),
        ("intervals.pfm", &["--method", "intervals", "--pass", "visibility"]),
        ("skins.exr", &["--method", "skins"]),
        ("channel.pfm", &["--pass", "visibility-channel"]),
        (
            "points.exr",
            &["--light", "linear:0,5,0:1,5,0", "--samples", "3", "--method", "point-samples"],
        ),
        ("pcss.pfm", &["--method", "pcss", "--pass", "visibility"]),
        ("traced.pfm", &["--method", "ray-traced", "--samples", "8", "--pass", "visibility"]),
        ("inside.png", &["--light", "sphere:0,1,1:0.1", "--method", "hard"]),
        ("sun.jpg", &["--light", "sun:-1,-2,-1:2"]),
    ] {
        let with = |settings: &[&str]| picture(name, &[more, settings].concat());
        let one = with(&["--threads", "1", "--simd", "scalar"]);
        assert!(with(&["--threads", "2", "--simd", "scalar"]) == one, "{name}, two threads");
        assert!(with(&["--threads", "3"]) == one, "{name}, three threads");
        for level in Level::available().map(|level| level.kind().name()) {
            assert!(with(&["--threads", "1", "--simd", level]) == one, "{name}, {level}");
        }
    }
}

#[test]
fn every_pass_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    for pass in ["beauty", "visibility", "depth", "ids", "normals", "light-depth", "light-ids"] {
        for ending in ["png", "jpg", "exr", "pfm"] {
            let name = format!("{pass}.{ending}");
            let arguments = ["render", "torus", "--size", "40x30", "--map-size", "32", "-o", &name];
            done(folder.path(), &[&arguments[..], &["--pass", pass]].concat());
            let picture = read(&folder.path().join(&name), MOST).unwrap();
            let size = if pass.starts_with("light") { (32, 32) } else { (40, 30) };
            assert_eq!((picture.width, picture.height), size, "{name}");
            let floats = matches!(picture.values, Values::Floats(..));
            assert_eq!(floats, matches!(ending, "exr" | "pfm"), "{name}");
            let colored =
                matches!(pass, "beauty" | "normals") || (pass.ends_with("ids") && !floats);
            assert_eq!(picture.channels, if colored { 3 } else { 1 }, "{name}");
        }
        let [exr, pfm] =
            ["exr", "pfm"].map(|ending| folder.path().join(format!("{pass}.{ending}")));
        let [exr, pfm] = [exr, pfm].map(|path| read(&path, MOST).unwrap());
        assert_eq!(exr.values, pfm.values, "{pass}");
    }
}

#[test]
fn comparison_of_known_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let pfm = |name: &str, values: [f32; 4]| {
        // Two rows of two, the lower row first.
        let mut file = b"Pf\n2 2\n-1.0\n".to_vec();
        file.extend(
            [values[2], values[3], values[0], values[1]].iter().flat_map(|v| v.to_le_bytes()),
        );
        fs::write(folder.path().join(name), file).unwrap();
    };
    pfm("a.pfm", [0.5, 0.25, 1.0, 0.0]);
    pfm("b.pfm", [0.5, 0.50, 0.0, 0.0]);
    pfm("other.pfm", [0.0, 1.0, 0.5, 1.0]);
    let json = |arguments: &[&str]| -> Value {
        let arguments = [&["compare", "a.pfm", "b.pfm"], arguments].concat();
        serde_json::from_slice(&done(folder.path(), &arguments).stdout).unwrap()
    };
    let near = |value: &Value, expected: f64| (value.as_f64().unwrap() - expected).abs() < 1e-9;
    let found = json(&["--diff", "diff.exr"]);
    // Differences 0, 0.25, 1, 0; the penumbra of b is its first row.
    assert!(near(&found["rmse"], (1.0625_f64 / 4.0).sqrt()), "{found}");
    assert!(near(&found["max"], 1.0), "{found}");
    assert_eq!(found["max_at"], serde_json::json!([0, 1]));
    assert_eq!(found["penumbra_pixels"], 2);
    assert!(near(&found["penumbra_rmse"], (0.0625_f64 / 2.0).sqrt()), "{found}");
    assert!(found["flip"].as_f64().unwrap() > 0.0);
    let difference = read(&folder.path().join("diff.exr"), MOST).unwrap();
    assert_eq!(difference.to_floats(), [0.0, 0.25, 1.0, 0.0]);
    let found = json(&["--reference", "other.pfm"]);
    assert_eq!(found["penumbra_pixels"], 1);
    assert!(near(&found["penumbra_rmse"], 1.0), "{found}");
    pfm("b.pfm", [0.5, 0.25, 1.0, 0.0]);
    let found = json(&[]);
    assert!(near(&found["rmse"], 0.0) && near(&found["max"], 0.0) && near(&found["flip"], 0.0));
}

/// A sound EXR file but for the size that its header names: 2^20 pixels along each side.
fn vast_exr(folder: &Path) -> Vec<u8> {
    done(folder, &["render", "blocker", "--method", "hard", "--size", "8x8", "-o", "small.exr"]);
    let mut file = fs::read(folder.join("small.exr")).unwrap();
    for window in ["dataWindow\0box2i\0", "displayWindow\0box2i\0"] {
        let name = file.windows(window.len()).position(|bytes| bytes == window.as_bytes());
        // The length of the attribute, then its least x and y.
        let greatest = name.unwrap() + window.len() + 4 + 8;
        let side = ((1_u32 << 20) - 1).to_le_bytes();
        file[greatest..greatest + 8].copy_from_slice(&[side, side].concat());
    }
    file
}

#[test]
fn pictures_that_cannot_be_compared() {
    let folder = tempfile::tempdir().unwrap();
    let size = |size, name| {
        let arguments = ["render", "blocker", "--method", "hard", "--size", size, "-o", name];
        done(folder.path(), &arguments);
    };
    size("8x8", "a.png");
    size("8x9", "b.png");
    fs::write(folder.path().join("broken.png"), "no picture").unwrap();
    fs::write(folder.path().join("broken.exr"), "no picture").unwrap();
    fs::write(folder.path().join("broken.pfm"), "Pf\n9999999 9999999\n-1\n").unwrap();
    fs::write(folder.path().join("vast.exr"), vast_exr(folder.path())).unwrap();
    for (other, words) in [
        ("b.png", "a.png: the pictures have different sizes: 8 x 8 and 8 x 9"),
        ("absent.png", "absent.png: "),
        ("broken.png", "broken.png: "),
        ("broken.exr", "broken.exr: "),
        ("broken.pfm", "broken.pfm: "),
        ("vast.exr", "vast.exr: the picture needs"),
        (".", "."),
    ] {
        let output = penumbra(folder.path(), &["compare", "a.png", other]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{message}");
        assert!(message.contains(words) && message.matches('\n').count() == 1, "{message}");
    }
}
