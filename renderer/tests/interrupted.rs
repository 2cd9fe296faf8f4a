//! Output appears whole or not at all: full disks, limits, and runs that are killed.
#![cfg(unix)]

use std::fs;
use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::thread::sleep;
use std::time::Instant;

use renderer::picture::read;
use test_models::skipped;

const PROGRAM: &str = env!("CARGO_BIN_EXE_penumbra");

/// A render of noticeable size.
fn render(folder: &Path, output: &str) -> Command {
    let mut command = Command::new(PROGRAM);
    command.current_dir(folder).args(["render", "torus", "--method", "hard", "--map-size", "64"]);
    command.args(["--size", "800x600", "--pass", "normals", "--threads", "1", "-o", output]);
    command
}

fn refused(output: &Output, reason: &str) {
    let message = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains(reason) && message.matches('\n').count() == 1, "{message}");
}

/// The names of all files, hidden ones too.
fn files(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

#[test]
fn a_full_device_is_an_error_of_one_line() {
    let full = Path::new("/dev/full");
    if !full.exists() {
        return skipped("this system has no /dev/full");
    }
    let folder = tempfile::tempdir().unwrap();
    std::os::unix::fs::symlink(full, folder.path().join("full.pfm")).unwrap();
    let output = render(folder.path(), "full.pfm").output().unwrap();
    refused(&output, "full.pfm: No space left on device");
    let mut compare = Command::new(PROGRAM);
    compare.current_dir(&folder).args(["compare", "full.pfm", "full.pfm"]);
    refused(&compare.output().unwrap(), "full.pfm: it is not a file");
}

#[test]
fn a_file_that_cannot_grow_leaves_the_old_one_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("picture.pfm"), "old").unwrap();
    // Files of at most 64 blocks; beyond, writing fails as it does on a full disk.
    let script = format!(
        "trap '' XFSZ; ulimit -f 64; exec {PROGRAM} render torus --method hard --map-size 64 \
         --size 800x600 --pass normals -o picture.pfm"
    );
    let output = Command::new("sh").args(["-c", &script]).current_dir(&folder).output().unwrap();
    refused(&output, "picture.pfm: File too large");
    assert_eq!(files(folder.path()), ["picture.pfm"]);
    assert_eq!(fs::read(folder.path().join("picture.pfm")).unwrap(), b"old");
}

#[test]
fn a_killed_run_leaves_a_whole_picture_or_none() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("picture.pfm");
    let start = Instant::now();
    assert!(render(folder.path(), "picture.pfm").status().unwrap().success());
    let whole_run = start.elapsed();
    let mut left = [0, 0];
    for run in 0..24 {
        let _ = fs::remove_file(&path);
        let mut child = render(folder.path(), "picture.pfm").stderr(Stdio::null()).spawn().unwrap();
        // Around the time when it writes; which side of it does not matter.
        sleep(whole_run * (12 + run) / 24);
        // Interrupts of the terminal end it as surely.
        child.kill().unwrap();
        child.wait().unwrap();
        let names = files(folder.path());
        assert!(names.is_empty() || names == ["picture.pfm"], "run {run}: {names:?}");
        left[names.len()] += 1;
        if !names.is_empty() {
            let picture = read(&path, 1 << 30).unwrap();
            assert_eq!((picture.width, picture.height), (800, 600), "run {run}");
        }
    }
    println!("{} runs left nothing, {} a whole picture", left[0], left[1]);
}
