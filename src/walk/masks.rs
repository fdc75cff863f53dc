//! Masks of the pixels that the lenses hide, made on a thread of their own: an image of millions of pixels takes
//! longer than a frame. Nothing is hidden until a mask is there.

use base::space::Fov;
use std::sync::mpsc::{Receiver, Sender, channel};
use xr::hidden_area::HiddenArea;

/// What a mask is for: fields of view and sizes of both eyes' images.
type MaskKey = ([Fov; 2], [[u32; 2]; 2]);

/// Sizes of the images, and their masks.
type MadeMasks = ([[u32; 2]; 2], [Vec<u32>; 2]);

enum Request {
    Areas([HiddenArea; 2]),
    Masks(MaskKey),
}

/// The frame thread's end.
#[derive(Debug)]
pub struct Masks {
    requests: Sender<Request>,
    results: Receiver<MadeMasks>,
    asked: Option<MaskKey>,
}

impl Default for Masks {
    /// Starts the thread, which ends when this is dropped.
    fn default() -> Self {
        let (requests, received) = channel();
        let (finished, results) = channel();
        std::thread::spawn(move || {
            // `None` while the headset has told nothing.
            let mut areas: Option<[HiddenArea; 2]> = None;
            for request in received {
                match (request, &areas) {
                    (Request::Areas(new), _) => areas = Some(new),
                    (Request::Masks((fovs, sizes_px)), Some(areas)) => {
                        let masks = [0, 1].map(|eye: usize| areas[eye].rasterize(&fovs[eye], sizes_px[eye]));
                        // Sending fails once the walk is over; then nobody asks either.
                        let _ = finished.send((sizes_px, masks));
                    }
                    (Request::Masks(_), None) => {}
                }
            }
        });
        Self { requests, results, asked: None }
    }
}

impl Masks {
    /// Sets new triangles that are hidden, left then right.
    pub fn set_areas(&mut self, areas: [HiddenArea; 2]) {
        // The thread listens as long as this exists.
        let _ = self.requests.send(Request::Areas(areas));
        self.asked = None;
    }

    /// Asks for the masks of images of these fields of view and sizes, unless that was the last thing asked for.
    pub fn ask(&mut self, fovs: [Fov; 2], sizes_px: [[u32; 2]; 2]) {
        if self.asked != Some((fovs, sizes_px)) {
            self.asked = Some((fovs, sizes_px));
            let _ = self.requests.send(Request::Masks((fovs, sizes_px)));
        }
    }

    /// Masks for images of these sizes, if they have become ready since the last call.
    pub fn take(&self, sizes_px: [[u32; 2]; 2]) -> Option<[Vec<u32>; 2]> {
        self.results.try_iter().filter(|(of, _)| *of == sizes_px).last().map(|(_, masks)| masks)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::{Duration, Instant};

    const FOV: Fov = Fov { left: -1.0, right: 1.0, up: 1.0, down: -1.0 };
    const PATIENCE: Duration = Duration::from_secs(10);

    fn corner() -> HiddenArea {
        HiddenArea { triangles: vec![[[-1.0, 1.0], [0.0, 1.0], [-1.0, 0.0]]] }
    }

    #[test]
    fn masks_come_for_what_was_asked_last() {
        let mut masks = Masks::default();
        // No mask comes without areas.
        masks.ask([FOV; 2], [[32, 32]; 2]);
        masks.set_areas([corner(), corner()]);
        masks.ask([FOV; 2], [[64, 64]; 2]);
        masks.ask([FOV; 2], [[32, 32]; 2]);
        let began = Instant::now();
        let got = loop {
            if let Some(got) = masks.take([[32, 32]; 2]) {
                break got;
            }
            assert!(began.elapsed() < PATIENCE, "no mask came");
            std::thread::yield_now();
        };
        assert_eq!(got[0].len(), 32);
        assert!(got[0][0] & 1 == 1 && got[0][31] == 0, "the top left corner is hidden");
        assert!(masks.take([[32, 32]; 2]).is_none(), "once");
    }
    #[test]
    fn masks_are_made_anew_for_a_reason_only() {
        let mut masks = Masks::default();
        let (small, large) = ([[32, 32]; 2], [[32, 32], [40, 40]]);
        let other = Fov { left: -2.0, ..FOV };
        let next = |masks: &Masks| masks.results.recv_timeout(PATIENCE).expect("masks");
        masks.set_areas([corner(), HiddenArea::default()]);
        masks.ask([FOV; 2], small);
        let (_, [left, right]) = next(&masks);
        assert_eq!(left, corner().rasterize(&FOV, [32, 32]));
        assert!(right.iter().all(|word| *word == 0), "each eye has its own");
        // A mask that is asked for again does not come before a new one.
        masks.ask([FOV; 2], small);
        masks.ask([FOV; 2], large);
        assert_eq!(next(&masks).0, large, "another size");
        masks.ask([FOV, other], large);
        next(&masks);
        masks.set_areas([HiddenArea::default(), corner()]);
        masks.ask([FOV, other], large);
        let (_, [left, right]) = next(&masks);
        assert!(left.iter().all(|word| *word == 0), "other triangles");
        assert_eq!(right, corner().rasterize(&other, [40, 40]));
        assert!(masks.results.try_recv().is_err());
    }
}
