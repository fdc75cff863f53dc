//! Screenshots: both eyes' images as the headset gets them, and with the overlay if one is on, as PNG files in the
//! current folder. A frame only records copies; a thread of its own waits for them and writes.

use super::link::WalkEnd;
use super::mirror::{Mirror, copy};
use crate::picture_files::{RgbImage, write_png};
use base::output::{Output, OutputError, OutputKind};
use render::gpu::Gpu;
use render::gpu::readback::ReadbackError;
use render::options::Overlay;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::{Duration, SystemTime, UNIX_EPOCH};

/// Pictures that are being taken, one screenshot at a time.
#[derive(Debug, Default)]
pub(super) struct Screenshots {
    /// True if the user wants a screenshot.
    asked: bool,
    /// Pictures that the frame being recorded has copied, each with what follows the files' stem.
    copied: Vec<(String, wgpu::Texture)>,
    writing: Option<JoinHandle<()>>,
}

impl Screenshots {
    /// Takes a screenshot of the next frame by which the last one is written.
    pub fn ask(&mut self) {
        self.asked = true;
    }

    /// Records the copies, if a screenshot is wanted; to be called after a frame and its mirror, with an overlay or
    /// none, were recorded into `images`.
    pub fn record(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        images: &[wgpu::Texture; 2],
        drawn_px: [[u32; 2]; 2],
        mirror: Option<&Mirror>,
        overlay: Overlay,
    ) {
        let is_writing = self.writing.as_ref().is_some_and(|thread| !thread.is_finished());
        if is_writing || !std::mem::take(&mut self.asked) {
            return;
        }
        let mut take = |images: &[wgpu::Texture; 2], kind: &str| {
            let usage = wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::COPY_SRC;
            let copies = [0, 1]
                .map(|eye: usize| gpu.texture("screenshot", drawn_px[eye], images[eye].format(), usage));
            copy(encoder, images, &copies, drawn_px);
            let names = ["left", "right"].map(|side| format!("{side}{kind}.png"));
            self.copied.extend(names.into_iter().zip(copies));
        };
        take(images, "");
        if let Some(shown) = mirror.and_then(Mirror::shown)
            && overlay != Overlay::None
        {
            take(&shown.textures, &format!(".{}", overlay.name()));
        }
    }

    /// Starts writing what was copied; to be called after the frame's submit.
    pub fn submitted(&mut self, gpu: &Arc<Gpu>, link: &WalkEnd) {
        if self.copied.is_empty() {
            return;
        }
        let (gpu, link, pictures) = (Arc::clone(gpu), link.clone(), std::mem::take(&mut self.copied));
        let write = move || {
            let now = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
            link.set_notice(match write(&gpu, Path::new(""), now, &pictures) {
                Ok(stem) => {
                    // Whoever started the program from a menu does not know its folder.
                    let stem = std::path::absolute(&stem).unwrap_or(stem);
                    format!("Saved {}.left.png and .right.png", stem.display())
                }
                Err(error) => format!("No screenshot: {error:#}"),
            });
        };
        self.writing = Some(std::thread::spawn(write));
    }

    /// Waits until the last screenshot is written.
    pub fn finish(&mut self) {
        if let Some(thread) = self.writing.take() {
            // If the thread panicked, the panic has been printed, and the walk is over anyway.
            let _ = thread.join();
        }
    }
}

/// Why there is no screenshot.
#[derive(Debug, thiserror::Error)]
enum ScreenshotError {
    /// The GPU gives no picture back.
    #[error(transparent)]
    Readback(#[from] ReadbackError),
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}

/// Writes pictures into `folder`; returns what their names begin with.
fn write(
    gpu: &Gpu,
    folder: &Path,
    since_1970: Duration,
    pictures: &[(String, wgpu::Texture)],
) -> Result<PathBuf, ScreenshotError> {
    let stem = folder.join(format!("scanwalk-{}", date_time(since_1970)));
    let path = |stem: &Path, name: &str| PathBuf::from(format!("{}.{name}", stem.display()));
    // A second screenshot within a second must not be written over the first.
    let numbered = (2..).map(|number| PathBuf::from(format!("{}-{number}", stem.display())));
    let is_free = |stem: &PathBuf| pictures.iter().all(|(name, _)| !path(stem, name).exists());
    let free = std::iter::once(stem.clone()).chain(numbered).find(is_free).unwrap_or(stem);
    // All pictures are written before the first gets its name. None takes the place of a file that has come
    // meanwhile.
    let mut written = Vec::new();
    for (name, picture) in pictures {
        let output = Output::fresh(path(&free, name), OutputKind::Picture)?;
        written.push((write_png(&output, &RgbImage::read(gpu, picture)?)?, output));
    }
    for (file, output) in written {
        output.keep(file)?;
    }
    Ok(free)
}

/// Date and time in UTC, "2026-03-01-235959", by the calendar's 400-year cycle of 146 097 days.
fn date_time(since_1970: Duration) -> String {
    let seconds = since_1970.as_secs();
    let is_leap =
        |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let (cycles, mut day) = (seconds / 86_400 / 146_097, seconds / 86_400 % 146_097);
    let mut year = 1970 + 400 * cycles;
    while day >= 365 + u64::from(is_leap(year)) {
        day -= 365 + u64::from(is_leap(year));
        year += 1;
    }
    let months = [31, 28 + u64::from(is_leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut month = 0;
    while day >= months[month] {
        day -= months[month];
        month += 1;
    }
    let (hour, minute, second) = (seconds / 3600 % 24, seconds / 60 % 60, seconds % 60);
    format!("{year:04}-{:02}-{:02}-{hour:02}{minute:02}{second:02}", month + 1, day + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_follow_the_calendar() {
        let text = |seconds| date_time(Duration::from_secs(seconds));
        assert_eq!(text(0), "1970-01-01-000000");
        assert_eq!(text(951_782_399), "2000-02-28-235959");
        assert_eq!(text(951_782_400), "2000-02-29-000000");
        assert_eq!(text(1_798_761_599), "2026-12-31-235959");
        assert_eq!(text(4_107_542_400), "2100-03-01-000000");
        assert_eq!(text(15_778_540_800), "2470-01-01-000000");
    }

    /// Two pixels of pure red.
    fn red(gpu: &Gpu, format: wgpu::TextureFormat) -> wgpu::Texture {
        let usage = wgpu::TextureUsages::COPY_SRC | wgpu::TextureUsages::RENDER_ATTACHMENT;
        let picture = gpu.texture("red", [2, 1], format, usage);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &picture.create_view(&Default::default()),
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::RED),
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        gpu.queue.lock().submit([encoder.finish()]);
        picture
    }

    #[test]
    fn no_screenshot_writes_over_another_and_a_failure_is_a_sentence() {
        let gpu = Gpu::open(None).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let formats = [wgpu::TextureFormat::Rgba8UnormSrgb, wgpu::TextureFormat::Bgra8UnormSrgb];
        let names = ["left.png", "right.png"].map(str::to_string);
        let pictures: Vec<_> = names.into_iter().zip(formats.map(|format| red(&gpu, format))).collect();
        let save = |folder: &Path| write(&gpu, folder, Duration::ZERO, &pictures);
        let stems = [save(folder.path()).unwrap(), save(folder.path()).unwrap()];
        let name = |stem: &PathBuf| stem.file_name().unwrap().to_str().unwrap().to_string();
        assert_eq!(
            stems.each_ref().map(name),
            ["scanwalk-1970-01-01-000000", "scanwalk-1970-01-01-000000-2"]
        );
        let files: Vec<_> =
            std::fs::read_dir(folder.path()).unwrap().map(|file| file.unwrap().path()).collect();
        assert_eq!(files.len(), 4);
        for path in files {
            let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
            let mut pixels = [0; 6];
            png::Decoder::new(file).read_info().unwrap().next_frame(&mut pixels).unwrap();
            assert_eq!(pixels, [255, 0, 0, 255, 0, 0], "red in both orders of the channels");
        }
        let error = format!("{:#}", save(&folder.path().join("missing")).unwrap_err());
        assert!(error.contains("missing") && error.contains("cannot be written"), "{error}");
    }
}
