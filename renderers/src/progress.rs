//! A progress bar on the terminal, and silence anywhere else.

use core::time::Duration;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;

/// A progress bar on standard error with the time gone by and the time left.
///
/// It is shown only when standard error is a terminal; otherwise nothing is ever written. Threads may share it by
/// reference: [`Progress::add`] costs an atomic addition, and the bar is redrawn at most ten times a second. The bar is
/// wiped when the value is dropped.
pub struct Progress {
    bar: Option<ProgressBar>,
}

impl Progress {
    /// A bar for `total` steps of a task that `label` names; shown when standard error is a terminal.
    #[must_use]
    pub fn new(label: &str, total: u64) -> Self {
        if std::io::stderr().is_terminal() {
            Self::on(ProgressDrawTarget::stderr_with_hz(10), label, total)
        } else {
            Self::silent()
        }
    }

    /// A bar that is never shown.
    #[must_use]
    pub fn silent() -> Self {
        Self { bar: None }
    }

    fn on(target: ProgressDrawTarget, label: &str, total: u64) -> Self {
        let bar = ProgressBar::with_draw_target(Some(total), target).with_prefix(label.to_owned());
        // A template that can't be parsed leaves the plain bar, which is as good.
        if let Ok(style) = ProgressStyle::with_template(TEMPLATE) {
            bar.set_style(style.progress_chars("=> "));
        }
        bar.enable_steady_tick(Duration::from_millis(500));
        Self { bar: Some(bar) }
    }

    /// Counts steps as done; from any thread.
    #[inline]
    pub fn add(&self, steps: u64) {
        if let Some(bar) = &self.bar {
            bar.inc(steps);
        }
    }

    /// Writes a line to standard error above the bar; nothing if there is none.
    pub fn note(&self, line: &str) {
        if let Some(bar) = &self.bar {
            bar.println(line);
        }
    }

    /// Steps done so far; 0 when the bar is not shown.
    #[must_use]
    pub fn done(&self) -> u64 {
        self.bar.as_ref().map_or(0, ProgressBar::position)
    }
}

const TEMPLATE: &str = "{prefix} [{bar:32}] {percent:>3} %  {elapsed_precise} gone, {eta_precise} left";

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use indicatif::TermLike;
    use rayon::prelude::*;
    use std::io;
    use std::sync::Mutex;

    /// A terminal that keeps what is written to it.
    #[derive(Clone, Copy, Debug)]
    struct Record(&'static Mutex<String>);

    impl TermLike for Record {
        fn width(&self) -> u16 {
            100
        }
        fn move_cursor_up(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_down(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_right(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn move_cursor_left(&self, _: usize) -> io::Result<()> {
            Ok(())
        }
        fn write_line(&self, text: &str) -> io::Result<()> {
            self.write_str(text)
        }
        fn write_str(&self, text: &str) -> io::Result<()> {
            self.0.lock().unwrap().push_str(text);
            Ok(())
        }
        fn clear_line(&self) -> io::Result<()> {
            Ok(())
        }
        fn flush(&self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn steps_of_all_threads_are_counted() {
        let progress = Progress::on(ProgressDrawTarget::hidden(), "rendering", 10_000);
        (0..10_000).into_par_iter().for_each(|_| progress.add(1));
        assert_eq!(progress.done(), 10_000);
    }

    #[test]
    fn the_bar_shows_label_share_and_both_times() {
        let record = Record(Box::leak(Box::default()));
        let progress = Progress::on(ProgressDrawTarget::term_like(Box::new(record)), "rendering", 200);
        progress.add(50);
        progress.bar.as_ref().unwrap().force_draw();
        let text = record.0.lock().unwrap().clone();
        assert!(text.contains("rendering [=======") && text.contains(" 25 %"), "{text}");
        assert!(text.contains("00:00:00 gone") && text.contains(" left"), "{text}");
    }

    #[test]
    fn a_silent_bar_does_nothing() {
        let progress = Progress::silent();
        progress.add(3);
        progress.note("nobody reads this");
        assert_eq!(progress.done(), 0);
    }
}
