//! Targets: how an image is linked for each, and what runs it.

use core::time::Duration;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// A machine without an operating system.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Target {
    pub(crate) name: &'static str,
    triple: &'static str,
    script: &'static str,
    emulator: &'static str,
    machine: &'static [&'static str],
    /// RAM in bytes.
    pub(crate) ram: u64,
    /// Picoseconds that SysTick takes for a tick.
    tick: u64,
}

/// Arm's MPS2 with AN386, 25 MHz; its 4 MB of flash have room for all rows at once.
pub(crate) const M4F: Target = Target {
    name: "Cortex-M4F",
    triple: "thumbv7em-none-eabihf",
    script: "thumbv7em.ld",
    emulator: "qemu-system-arm",
    machine: &["-M", "mps2-an386"],
    ram: 1 << 20,
    tick: 40_000,
};
/// TI's LM3S6965.
pub(crate) const M3: Target = Target {
    name: "Cortex-M3",
    triple: "thumbv7m-none-eabi",
    script: "thumbv7m.ld",
    emulator: "qemu-system-arm",
    machine: &["-M", "lm3s6965evb"],
    ram: 64 << 10,
    tick: 20_000,
};
/// BBC's micro:bit with Nordic's nRF51, 16 MHz.
pub(crate) const M0: Target = Target {
    name: "Cortex-M0",
    triple: "thumbv6m-none-eabi",
    script: "thumbv6m.ld",
    emulator: "qemu-system-arm",
    machine: &["-M", "microbit"],
    ram: 16 << 10,
    tick: 62_500,
};
/// QEMU's own machine.
pub(crate) const RV32: Target = Target {
    name: "RV32IMAC",
    triple: "riscv32imac-unknown-none-elf",
    script: "riscv32.ld",
    emulator: "qemu-system-riscv32",
    machine: &["-M", "virt", "-bios", "none"],
    ram: 1 << 20,
    tick: 0,
};
/// All of them.
pub(crate) const ALL: [Target; 4] = [M4F, M3, M0, RV32];

/// Instructions are a multiple of 2⁴ ns each: two or four of them for a tick.
const SHIFT: u32 = 4;
/// Semihosting on standard output, and nothing else there.
const CONSOLE: [&str; 10] = [
    "-display",
    "none",
    "-serial",
    "none",
    "-monitor",
    "none",
    "-chardev",
    "stdio,id=host",
    "-semihosting-config",
    "enable=on,target=native,chardev=host",
];
/// A time that no image needs.
const PATIENCE: Duration = Duration::from_secs(120);

/// The numbers that an image prints of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Row {
    pub(crate) digest: u64,
    pub(crate) results: u64,
    ticks: u64,
    calls: u64,
    /// Bytes of stack, the harness's included.
    pub(crate) stack: u64,
}

impl Row {
    /// Instructions of all calls, and the number of calls.
    pub(crate) fn instructions(&self, target: &Target) -> (f64, f64) {
        // The clock counts in the upper 24 of 32 bits.
        let picoseconds = (self.ticks >> 8) as f64 * target.tick as f64;
        (picoseconds / (1000.0 * f64::from(1 << SHIFT)), self.calls as f64)
    }
}

/// What an image prints: its rows, and its sizes in bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Report {
    pub(crate) rows: Vec<Row>,
    pub(crate) flash: u64,
    pub(crate) static_ram: u64,
}

/// Where things are.
#[derive(Clone, Debug)]
pub(crate) struct Tools {
    pub(crate) linker: PathBuf,
    pub(crate) scripts: PathBuf,
    pub(crate) built: PathBuf,
}

/// Why there is no image.
#[derive(Clone, Debug)]
pub(crate) enum LinkError {
    /// A panic is left.
    Panic,
    /// The image is larger than the machine's flash.
    Full,
    /// Anything else, in the linker's words.
    Other(String),
}

impl Target {
    /// The image of the symbols `wanted`, with `main` as the start.
    pub(crate) fn link(&self, tools: &Tools, main: &str, wanted: &[String], image: &Path) -> Result<(), LinkError> {
        let archive = tools.built.join(self.triple).join("release/libembedded_image.a");
        let mut command = Command::new(&tools.linker);
        command.args(["-flavor", "gnu", "--gc-sections", "-L"]).arg(&tools.scripts);
        command.arg("-T").arg(tools.scripts.join(self.script)).arg(format!("--defsym=main={main}"));
        for symbol in wanted {
            command.args(["-u", symbol]);
        }
        let output = command.arg("-o").arg(image).arg(archive).output();
        let output = output.map_err(|error| LinkError::Other(format!("{}: {error}", tools.linker.display())))?;
        let words = String::from_utf8_lossy(&output.stderr).into_owned();
        match output.status.success() {
            true => Ok(()),
            false if words.contains("undefined symbol: a_panic_is_left") => Err(LinkError::Panic),
            false if words.contains("will not fit in region") => Err(LinkError::Full),
            false => Err(LinkError::Other(words)),
        }
    }

    /// Runs an image; what it printed, when it ended well. The time is counted in instructions if `is_timed`.
    pub(crate) fn run(&self, image: &Path, is_timed: bool) -> Result<String, String> {
        let mut command = Command::new(self.emulator);
        command.args(self.machine).args(CONSOLE).arg("-kernel").arg(image);
        if is_timed {
            command.args(["-icount", &format!("shift={SHIFT}")]);
        }
        let name = self.name;
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = command.spawn().map_err(|error| format!("{}: {error}", self.emulator))?;
        let start = Instant::now();
        while child.try_wait().map_err(|error| error.to_string())?.is_none() {
            if start.elapsed() > PATIENCE {
                child.kill().map_err(|error| error.to_string())?;
                return Err(format!("{name}: no end after {} s", PATIENCE.as_secs()));
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        let output = child.wait_with_output().map_err(|error| error.to_string())?;
        let [text, words] = [output.stdout, output.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        if output.status.success() { Ok(text) } else { Err(format!("{name}: {}\n{text}{words}", output.status)) }
    }

    /// Links and runs an image of rows.
    pub(crate) fn measure(
        &self,
        tools: &Tools,
        wanted: &[String],
        image: &Path,
        is_timed: bool,
    ) -> Result<Report, LinkError> {
        self.link(tools, "rows_main", wanted, image)?;
        let text = self.run(image, is_timed).map_err(LinkError::Other)?;
        parse(&text, wanted.len()).ok_or_else(|| LinkError::Other(format!("{}: unexpected output\n{text}", self.name)))
    }
}

fn parse(text: &str, count: usize) -> Option<Report> {
    let lines = text.lines().filter(|line| !line.trim().is_empty());
    let lines: Vec<Vec<u64>> = lines
        .map(|line| line.split_whitespace().map(|word| u64::from_str_radix(word, 16).ok()).collect())
        .collect::<Option<_>>()?;
    let (last, rows) = lines.split_last()?;
    let &[flash, static_ram] = last.as_slice() else { return None };
    let rows: Vec<Row> = rows
        .iter()
        .map(|line| {
            let &[digest, results, ticks, calls, stack] = line.as_slice() else { return None };
            Some(Row { digest, results, ticks, calls, stack })
        })
        .collect::<Option<_>>()?;
    (rows.len() == count).then_some(Report { rows, flash, static_ram })
}
