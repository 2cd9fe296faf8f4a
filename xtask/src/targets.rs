//! The targets that the workspace is built for, and what each of them needs.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::run::{cargo_command, root};

/// A target other than the machine's own.
pub struct Target {
    /// As the tables name it.
    pub name: &'static str,
    /// As the compiler names it.
    pub triple: &'static str,
    /// The standard crates to build from source.
    pub std: &'static str,
    /// The linker, if the compiler's default cannot be used.
    pub linker: Option<&'static str>,
    /// The program that runs the target's programs, and its arguments. `{prefix}` stands for the
    /// folder of the target's C library.
    pub runner: &'static [&'static str],
    /// Flags for the compiler.
    pub flags: &'static str,
    /// Debian packages that bring linker, C library and runner.
    pub packages: &'static [&'static str],
}

const BARE: Target = Target {
    name: "",
    triple: "",
    std: "core,alloc",
    linker: Some("ld.lld-22"),
    runner: &[],
    flags: "",
    packages: &["lld-22"],
};

const WASM: Target = Target {
    name: "wasm32",
    triple: "wasm32-unknown-unknown",
    std: "std,panic_abort",
    linker: Some("wasm-ld-22"),
    runner: &["node", "tests/verify/run.mjs"],
    flags: "",
    packages: &["lld-22", "nodejs"],
};

/// AArch64 Linux, with NEON.
pub const AARCH64: Target = Target {
    name: "aarch64",
    triple: "aarch64-unknown-linux-gnu",
    std: "std,panic_unwind,test",
    linker: Some("aarch64-linux-gnu-gcc"),
    runner: &["qemu-aarch64", "-L", "{prefix}"],
    flags: "",
    packages: &["gcc-aarch64-linux-gnu", "libc6-dev-arm64-cross", "qemu-user"],
};

/// 32-bit x86 Linux, which runs natively.
pub const I686: Target = Target {
    name: "i686",
    triple: "i686-unknown-linux-gnu",
    std: "std,panic_unwind,test",
    linker: Some("i686-linux-gnu-gcc"),
    runner: &[],
    flags: "",
    packages: &["gcc-i686-linux-gnu", "libc6-dev-i386-cross", "libc6-i386", "lib32gcc-s1"],
};

/// WebAssembly without and with SIMD.
pub const WASMS: [Target; 2] = [
    Target { name: "wasm32", ..WASM },
    Target { name: "wasm32 simd128", flags: "-Ctarget-feature=+simd128", ..WASM },
];

/// A microcontroller, run in an emulator.
pub const THUMB: Target = Target {
    name: "thumbv7em",
    triple: "thumbv7em-none-eabihf",
    runner: &[
        "qemu-system-arm",
        "-cpu",
        "cortex-m4",
        "-machine",
        "mps2-an386",
        "-nographic",
        "-monitor",
        "none",
        "-serial",
        "null",
        "-semihosting-config",
        "enable=on,target=native",
        "-kernel",
    ],
    packages: &["lld-22", "qemu-system-arm"],
    ..BARE
};

/// Bare metal where nothing runs: the algorithm crates are built.
pub const BARE_METAL: [Target; 3] = [
    Target { name: "aarch64 bare", triple: "aarch64-unknown-none", ..BARE },
    Target { name: "riscv64 bare", triple: "riscv64gc-unknown-none-elf", ..BARE },
    Target { name: "x86_64 bare", triple: "x86_64-unknown-none", ..BARE },
];

/// Windows, built only.
pub const WINDOWS: Target = Target {
    name: "windows",
    triple: "x86_64-pc-windows-gnu",
    std: "std,panic_unwind",
    linker: Some("x86_64-w64-mingw32-gcc"),
    runner: &[],
    flags: "",
    packages: &["gcc-mingw-w64-x86-64"],
};

/// The toolchain that can build the standard crates from source: Debian's, which ships their
/// source.
pub struct Toolchain {
    folder: PathBuf,
}

impl Toolchain {
    const PACKAGES: [&str; 3] = ["rustc-web", "cargo-web", "rust-web-src"];

    /// Finds the toolchain and the target's tools, installing what is missing where that is
    /// allowed.
    ///
    /// # Errors
    ///
    /// What is missing, in one line.
    pub fn with_tools(target: &Target) -> Result<Toolchain, String> {
        install(&Self::PACKAGES)?;
        install(target.packages)?;
        let list = Command::new("dpkg").args(["-L", "rustc-web"]).output();
        let list = list.map_err(|error| format!("dpkg: {error}"))?.stdout;
        let list = String::from_utf8_lossy(&list).into_owned();
        let rustc = list.lines().find(|line| line.ends_with("bin/rustc"));
        let folder = rustc.and_then(|path| Path::new(path).parent());
        Ok(Toolchain { folder: folder.ok_or("rustc-web has no rustc")?.to_owned() })
    }

    /// A cargo command for the target, its linker and its runner set, in a target folder of its
    /// own so that the standard crates stay built.
    pub fn cargo(&self, target: &Target, arguments: &str) -> Command {
        let mut command = Command::new(self.folder.join("cargo"));
        command.current_dir(root()).args(arguments.split_whitespace());
        command.arg(format!("-Zbuild-std={}", target.std)).args(["--target", target.triple]);
        let variable = |what: &str| {
            let triple = target.triple.to_uppercase().replace('-', "_");
            format!("CARGO_TARGET_{triple}_{what}")
        };
        let path = std::env::var("PATH").unwrap_or_default();
        command
            .env("PATH", format!("{}:{path}", self.folder.display()))
            .env("RUSTC", self.folder.join("rustc"))
            .env("RUSTDOC", self.folder.join("rustdoc"))
            .env("RUSTC_BOOTSTRAP", "1")
            .env("RUSTFLAGS", target.flags)
            .env("CARGO_TARGET_DIR", self.target_folder(target));
        if let Some(linker) = target.linker {
            command.env(variable("LINKER"), linker);
        }
        if !target.runner.is_empty() {
            command.env(variable("RUNNER"), runner(target).join(" "));
        }
        command
    }

    /// Where the target's build results lie.
    pub fn target_folder(&self, target: &Target) -> PathBuf {
        root().join("target/cross").join(target.name.replace(' ', "-"))
    }
}

fn runner(target: &Target) -> Vec<String> {
    let gcc = target.linker.unwrap_or_default();
    let libc = Command::new(gcc).arg("-print-file-name=libc.so.6").output();
    let libc = libc.map(|out| String::from_utf8_lossy(&out.stdout).trim().to_owned());
    let prefix =
        libc.ok().and_then(|libc| Path::new(&libc).parent()?.parent()?.canonicalize().ok());
    let prefix = prefix.unwrap_or_default().display().to_string();
    target.runner.iter().map(|word| word.replace("{prefix}", &prefix)).collect()
}

/// Installs Debian packages that are missing.
fn install(packages: &[&str]) -> Result<(), String> {
    let missing: Vec<&str> = packages.iter().copied().filter(|name| !installed(name)).collect();
    if missing.is_empty() {
        return Ok(());
    }
    println!("    installing {}", missing.join(" "));
    let apt = |arguments: &[&str]| {
        let mut command = Command::new("apt-get");
        command.args(["-qq", "-o=Dpkg::Use-Pty=0"]).args(arguments);
        command.env("DEBIAN_FRONTEND", "noninteractive");
        let output = command.output().map_err(|_| "no apt-get on this machine".to_owned())?;
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        output.status.success().then_some(()).ok_or(error)
    };
    apt(&["update"])?;
    let mut arguments = vec!["install", "-y", "--no-install-recommends"];
    arguments.extend(&missing);
    apt(&arguments).map_err(|error| {
        format!(
            "needs {} ({})",
            missing.join(" "),
            error.lines().next().unwrap_or("apt-get failed")
        )
    })
}

/// Whether a package, or another that serves in its place, is there.
fn installed(package: &str) -> bool {
    if package == "nodejs" {
        return Command::new("node").arg("--version").output().is_ok();
    }
    let status = Command::new("dpkg-query").args(["-W", "-f=${Status}", package]).output();
    status.is_ok_and(|output| output.stdout.ends_with(b"install ok installed"))
}

/// The same as [`Toolchain::cargo`] for this machine, with flags of its own.
pub fn host_cargo(name: &str, flags: &str, arguments: &str) -> Command {
    let mut command = cargo_command(arguments);
    let folder = root().join("target/cross").join(name);
    command.current_dir(root()).env("RUSTFLAGS", flags).env("CARGO_TARGET_DIR", folder);
    command
}
