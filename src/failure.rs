//! Why a command fails: one type from where it happens to where somebody decides by it.

use crate::desktop::DesktopError;
use crate::draw::no_gpu;
use crate::loader::LoadError;
use crate::offscreen::PictureError;
use crate::walk::WalkError;
use crate::walk::headsets::NoHeadset;
use base::output::OutputError;
use lab::report::BenchError;
use lab::synth::SynthError;
use points::ScanError;
use render::gpu::GpuError;
use std::io;
use timing::log::LogError;
use timing::pose_path::PosePathError;

/// Why a command fails.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// The command line asks for something that makes no sense or does not exist.
    #[error("{0}")]
    Usage(String),
    /// A file that is read does not hold what is asked of it; the sentence says which and why.
    #[error("{0}")]
    Input(String),
    /// An output is refused or cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The result cannot be printed.
    #[error("the result cannot be printed")]
    Print(#[from] io::Error),
    /// A scan cannot be read.
    #[error(transparent)]
    Scan(#[from] ScanError),
    /// A picture cannot be drawn.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// A scan cannot be made up.
    #[error(transparent)]
    Synth(#[from] SynthError),
    /// There is no GPU that can be used.
    #[error("{}", no_gpu(.0))]
    Gpu(#[from] GpuError),
    /// There is no headset to walk with.
    #[error(transparent)]
    Headset(#[from] NoHeadset),
    /// There is no window, and one is required.
    #[error("--window on")]
    Window(#[source] DesktopError),
    /// The window of a walk fails.
    #[error(transparent)]
    Desktop(#[from] DesktopError),
    /// The scan of a walk cannot be shown.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A walk cannot go on.
    #[error(transparent)]
    Walk(#[from] WalkError),
    /// The head's path cannot be read.
    #[error(transparent)]
    PosePath(#[from] PosePathError),
    /// A frame log cannot be begun.
    #[error(transparent)]
    Log(#[from] LogError),
    /// A frame log cannot be read.
    #[error(transparent)]
    LogFile(#[from] timing::ReadError),
    /// The results of a benchmark cannot be read.
    #[error(transparent)]
    Results(#[from] BenchError),
    /// A benchmark fails, for a reason that nobody decides by.
    #[error(transparent)]
    Bench(anyhow::Error),
}

impl Failure {
    /// True if the command asks for something that makes no sense; false if what it asks for fails.
    #[must_use]
    pub fn is_usage(&self) -> bool {
        match self {
            Self::Usage(_) => true,
            Self::Output(error)
            | Self::Picture(PictureError::Output(error))
            | Self::Log(LogError::Create(error)) => error.is_usage(),
            Self::Picture(error) => matches!(error, PictureError::Usage(_)),
            Self::Synth(error) => error.is_usage(),
            _ => false,
        }
    }

    /// True if the reader of stdout has read enough (`scanwalk … | head`), which is no failure.
    #[must_use]
    pub fn is_closed_pipe(&self) -> bool {
        match self {
            Self::Print(error) => error.kind() == io::ErrorKind::BrokenPipe,
            Self::Output(error)
            | Self::Picture(PictureError::Output(error))
            | Self::Log(LogError::Create(error))
            | Self::Synth(SynthError::Output(error)) => error.is_closed_pipe(),
            Self::Synth(SynthError::Write { source, .. }) => source.kind() == io::ErrorKind::BrokenPipe,
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    fn output(kind: io::ErrorKind) -> OutputError {
        OutputError::Write { path: PathBuf::from("-"), source: kind.into() }
    }

    #[test]
    fn wrong_usage_is_told_from_what_fails() {
        assert!(Failure::Usage("no".into()).is_usage() && !Failure::Input("no".into()).is_usage());
        assert!(Failure::Picture(PictureError::Usage("no".into())).is_usage());
        assert!(Failure::from(SynthError::NoPoints).is_usage());
        assert!(!Failure::from(io::Error::other("x")).is_usage());
        assert!(!Failure::from(output(io::ErrorKind::StorageFull)).is_usage());
    }

    #[test]
    fn a_closed_pipe_is_told_from_what_fails() {
        let closed = || output(io::ErrorKind::BrokenPipe);
        let failures: [Failure; 4] = [
            io::Error::from(io::ErrorKind::BrokenPipe).into(),
            closed().into(),
            PictureError::from(closed()).into(),
            SynthError::from(closed()).into(),
        ];
        for failure in failures {
            assert!(failure.is_closed_pipe() && !failure.is_usage(), "{failure:?}");
        }
        assert!(!Failure::from(output(io::ErrorKind::StorageFull)).is_closed_pipe());
        assert!(!Failure::Usage("no".into()).is_closed_pipe());
    }
}
