//! GPU times of a frame's passes, and a few bytes more, read back some frames late without ever waiting.
//!
//! A stage lasts from the end of the stage before to its own end, so the stages' times add up to the frame's.
//! Yet a timestamp is also written where each stage begins: Mesa's software driver gives a timestamp its
//! value only when the next one is written, so without them an end would be as late as the next stage's.

use super::Gpu;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};

/// Frames that may be under way at once; a frame beyond that goes without times.
const NUM_SLOTS: usize = 8;

/// State of a slot's readback buffer: free for a frame.
const IDLE: u8 = 0;
/// State of a slot's readback buffer: asked for, and not there yet.
const WAITING: u8 = 1;
/// State of a slot's readback buffer: there to be read.
const MAPPED: u8 = 2;
/// State of a slot's readback buffer: lost.
const FAILED: u8 = 3;

/// A ring of query sets and readback buffers.
#[derive(Debug)]
pub struct Timer {
    slots: Vec<Slot>,
    num_stages: usize,
    extra_bytes: u64,
    milliseconds_per_tick: f64,
    /// Slot of the frame being recorded.
    current: Option<usize>,
    /// Stage times of the frame that is being collected; kept so that collecting allocates nothing.
    stage_ms: Vec<f32>,
}

#[derive(Debug)]
struct Slot {
    frame: u64,
    /// `None` if the device cannot time.
    queries: Option<wgpu::QuerySet>,
    resolved: wgpu::Buffer,
    readback: wgpu::Buffer,
    state: Arc<AtomicU8>,
}

/// Times and bytes that came back of a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Times<'a> {
    /// The frame's number, as given to [`Timer::begin`].
    pub frame: u64,
    /// Milliseconds of each stage; NaN where the device gave none.
    pub stage_ms: &'a [f32],
    /// Milliseconds from the first stage's start to the last stage's end.
    pub total_ms: f32,
    /// The bytes copied by [`Timer::end`]; empty if they were lost.
    pub extra: &'a [u8],
}

impl Timer {
    /// A timer for frames of `num_stages` stages, with `extra_bytes` read back besides.
    #[must_use]
    pub fn new(gpu: &Gpu, num_stages: usize, extra_bytes: u64) -> Self {
        let can_time = gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
        let count = 2 * (1 + num_stages as u32);
        let query_bytes = u64::from(count) * 8;
        let slot = |_| Slot {
            frame: 0,
            queries: can_time.then(|| {
                gpu.device.create_query_set(&wgpu::QuerySetDescriptor {
                    label: Some("timer"),
                    ty: wgpu::QueryType::Timestamp,
                    count,
                })
            }),
            resolved: gpu.buffer(
                "timer resolved",
                query_bytes,
                wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
            ),
            readback: gpu.buffer(
                "timer readback",
                query_bytes + extra_bytes,
                wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            ),
            state: Arc::new(AtomicU8::new(IDLE)),
        };
        Self {
            slots: (0..NUM_SLOTS).map(slot).collect(),
            num_stages,
            extra_bytes,
            milliseconds_per_tick: 1e-6 * f64::from(gpu.queue.lock().timestamp_period()),
            current: None,
            stage_ms: vec![f32::NAN; num_stages],
        }
    }

    /// Begins a frame, whose first stage begins now.
    pub fn begin(&mut self, encoder: &mut wgpu::CommandEncoder, frame: u64) {
        self.current = self.slots.iter().position(|s| s.state.load(Ordering::Acquire) == IDLE);
        let Some(slot) = self.current.map(|i| &mut self.slots[i]) else { return };
        slot.frame = frame;
        if let Some(query_set) = &slot.queries {
            // The end of this empty pass is the first stage's beginning.
            encoder.begin_compute_pass(&wgpu::ComputePassDescriptor {
                label: Some("begin"),
                timestamp_writes: Some(wgpu::ComputePassTimestampWrites {
                    query_set,
                    beginning_of_pass_write_index: Some(0),
                    end_of_pass_write_index: Some(1),
                }),
            });
        }
    }

    fn writes(
        &self,
        stage: usize,
        first: bool,
        last: bool,
    ) -> Option<(&wgpu::QuerySet, Option<u32>, Option<u32>)> {
        let queries = self.slots[self.current?].queries.as_ref()?;
        let at = |wanted: bool, end: u32| wanted.then_some(2 * (1 + stage as u32) + end);
        (first || last).then_some((queries, at(first, 0), at(last, 1)))
    }

    /// Timestamps for a compute pass: the stage's `first` pass, its `last`, both, or neither.
    #[must_use]
    pub fn compute(
        &self,
        stage: usize,
        first: bool,
        last: bool,
    ) -> Option<wgpu::ComputePassTimestampWrites<'_>> {
        let (query_set, begin, end) = self.writes(stage, first, last)?;
        Some(wgpu::ComputePassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: begin,
            end_of_pass_write_index: end,
        })
    }

    /// Timestamps for a render pass, as [`Self::compute`] gives them for a compute pass.
    #[must_use]
    pub fn render(
        &self,
        stage: usize,
        first: bool,
        last: bool,
    ) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let (query_set, begin, end) = self.writes(stage, first, last)?;
        Some(wgpu::RenderPassTimestampWrites {
            query_set,
            beginning_of_pass_write_index: begin,
            end_of_pass_write_index: end,
        })
    }

    /// Records the copies that bring times and `extra` bytes back.
    pub fn end(&mut self, encoder: &mut wgpu::CommandEncoder, extra: &wgpu::Buffer) {
        let Some(slot) = self.current.map(|i| &self.slots[i]) else { return };
        let query_bytes = slot.resolved.size();
        if let Some(queries) = &slot.queries {
            encoder.resolve_query_set(queries, 0..2 * (1 + self.num_stages as u32), &slot.resolved, 0);
            encoder.copy_buffer_to_buffer(&slot.resolved, 0, &slot.readback, 0, query_bytes);
        }
        encoder.copy_buffer_to_buffer(extra, 0, &slot.readback, query_bytes, self.extra_bytes);
    }

    /// To be called after the submit: asks for the readback, which a later [`Timer::collect`] finds.
    pub fn submitted(&mut self) {
        let Some(slot) = self.current.take().map(|i| &self.slots[i]) else { return };
        slot.state.store(WAITING, Ordering::Release);
        let state = Arc::clone(&slot.state);
        slot.readback.map_async(wgpu::MapMode::Read, .., move |result| {
            state.store(if result.is_ok() { MAPPED } else { FAILED }, Ordering::Release);
        });
    }

    /// Hands the oldest frame that has come back, if any, to `read`. It never waits and allocates nothing; call it
    /// until it gives `None`.
    pub fn collect<R>(&mut self, gpu: &Gpu, read: impl FnOnce(Times) -> R) -> Option<R> {
        // A lost device shows at the next submit; here it only means that nothing comes back.
        let _ = gpu.poll(wgpu::PollType::Poll);
        let done = |s: &&Slot| matches!(s.state.load(Ordering::Acquire), MAPPED | FAILED);
        let slot = self.slots.iter().filter(done).min_by_key(|s| s.frame)?;
        let view = slot.readback.get_mapped_range(..).ok();
        let bytes: &[u8] = view.as_deref().unwrap_or(&[]);
        let (ticks, extra) = bytes.split_at((slot.resolved.size() as usize).min(bytes.len()));
        let ticks = if slot.queries.is_some() { ticks } else { &[] };
        for (stage, ms) in self.stage_ms.iter_mut().enumerate() {
            *ms = elapsed(ticks, 2 * stage + 1, 2 * stage + 3, self.milliseconds_per_tick);
        }
        let total_ms = elapsed(ticks, 1, 2 * self.num_stages + 1, self.milliseconds_per_tick);
        let result = read(Times { frame: slot.frame, stage_ms: &self.stage_ms, total_ms, extra });
        drop(view);
        if slot.state.swap(IDLE, Ordering::AcqRel) == MAPPED {
            slot.readback.unmap();
        }
        Some(result)
    }
}

/// Milliseconds between two timestamps of a readback; NaN where it has none.
fn elapsed(ticks: &[u8], from: usize, to: usize, milliseconds_per_tick: f64) -> f32 {
    let tick = |index: usize| ticks.get(8 * index..8 * index + 8).map(bytemuck::pod_read_unaligned::<u64>);
    match (tick(from), tick(to)) {
        (Some(from), Some(to)) => (to.saturating_sub(from) as f64 * milliseconds_per_tick) as f32,
        _ => f32::NAN,
    }
}
