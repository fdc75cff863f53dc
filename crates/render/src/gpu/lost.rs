//! A GPU that is lost while it is used: waiting for it, and work with libraries that have no word for it.

use super::Gpu;
use std::cell::RefCell;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind, set_hook, take_hook};
use std::sync::{Arc, Once, OnceLock};

/// The GPU is lost: nothing more comes of work that is sent to it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the GPU is lost: {0}")]
pub struct GpuLost(pub String);

/// Why waiting for the GPU was in vain.
#[derive(Debug, thiserror::Error)]
pub enum PollError {
    /// It is lost.
    #[error(transparent)]
    Lost(#[from] GpuLost),
    /// It did not come to the end in time, or was never to.
    #[error(transparent)]
    Wait(#[from] wgpu::PollError),
}

thread_local! {
    /// The reason of a loss, once there is one, of the GPU that this thread works with in [`Gpu::unless_lost`].
    static WORKS_WITH: RefCell<Option<Arc<OnceLock<String>>>> = const { RefCell::new(None) };
}

impl Gpu {
    /// Does work that panics where the GPU is lost meanwhile. wgpu 30 does so in its poll and with mapped buffers,
    /// egui-wgpu 0.37 in its uploads; neither has an error for it. Any other panic goes on.
    ///
    /// # Errors
    /// The GPU was lost before the work, or the work panicked and the GPU is lost. What the work was about is not to be
    /// used any more.
    pub fn unless_lost<T>(&self, work: impl FnOnce() -> T) -> Result<T, GpuLost> {
        let lost = || self.lost().map(|reason| GpuLost(reason.to_owned()));
        if let Some(lost) = lost() {
            return Err(lost);
        }
        keep_panics_of_losses_quiet();
        let before = WORKS_WITH.replace(Some(Arc::clone(&self.lost)));
        let done = catch_unwind(AssertUnwindSafe(work));
        WORKS_WITH.set(before);
        done.map_err(|panic| lost().unwrap_or_else(|| resume_unwind(panic)))
    }

    /// Runs the callbacks whose time has come, and waits for the GPU if `wanted` says so.
    ///
    /// # Errors
    /// See [`PollError`].
    pub fn poll(&self, wanted: wgpu::PollType) -> Result<wgpu::PollStatus, PollError> {
        Ok(self.unless_lost(|| self.device.poll(wanted))??)
    }
}

/// Has nothing printed of panics for which a loss is the reason: they are no mistakes of the program.
fn keep_panics_of_losses_quiet() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        let print = take_hook();
        set_hook(Box::new(move |panic| {
            let is_lost =
                |lost: &Option<Arc<OnceLock<String>>>| lost.as_ref().is_some_and(|lost| lost.get().is_some());
            if !WORKS_WITH.with_borrow(is_lost) {
                print(panic);
            }
        }));
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panic_of(work: impl FnOnce()) -> bool {
        catch_unwind(AssertUnwindSafe(work)).is_err()
    }

    #[test]
    fn a_panic_is_an_error_only_where_the_gpu_is_lost() {
        let gpu = Gpu::open(None).unwrap();
        assert_eq!(gpu.unless_lost(|| 3), Ok(3));
        assert!(panic_of(|| drop(gpu.unless_lost(|| panic!("a mistake, for this test")))));
        let lost = gpu.unless_lost(|| {
            gpu.device.destroy();
            // The loss is told by the next poll.
            let _ = gpu.device.poll(wgpu::PollType::Poll);
            panic!("wgpu's");
        });
        let lost: GpuLost = Result::<(), _>::unwrap_err(lost);
        assert!(matches!(gpu.poll(wgpu::PollType::Poll), Err(PollError::Lost(again)) if again == lost));
        assert_eq!(gpu.unless_lost(|| panic!("it is not even tried")), Result::<(), _>::Err(lost));
    }
}
