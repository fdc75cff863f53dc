//! Masks of the pixels that the lenses hide, made on a thread of their own: an image of millions of pixels takes
//! longer than a frame. Until a mask is there, nothing is hidden.

use super::hidden_area::{HiddenArea, HiddenPixels};
use crate::space::Fov;
use std::sync::mpsc::{Receiver, Sender, channel};

/// What a mask is for: fields of view and sizes of both eyes' images.
type For = ([Fov; 2], [[u32; 2]; 2]);

/// Sizes of the images, and their masks.
type Made = ([[u32; 2]; 2], [Vec<u32>; 2]);

enum Request {
    Areas([HiddenArea; 2]),
    Masks(For),
}

/// The frame thread's end.
#[derive(Debug)]
pub struct Masks {
    requests: Sender<Request>,
    results: Receiver<Made>,
    asked: Option<For>,
}

impl Default for Masks {
    /// Starts the thread, which ends with this.
    fn default() -> Self {
        let (requests, received) = channel();
        let (finished, results) = channel();
        std::thread::spawn(move || {
            let mut hidden = HiddenPixels::default();
            for request in received {
                match request {
                    Request::Areas(areas) => hidden.set_areas(areas),
                    Request::Masks((fovs, sizes_px)) => {
                        let masks = hidden.update(fovs, sizes_px);
                        // Nobody listens once the walk is over; then nobody asks either.
                        let _ = masks.map(|masks| finished.send((sizes_px, masks)));
                    }
                }
            }
        });
        Self { requests, results, asked: None }
    }
}

impl Masks {
    /// New triangles, left then right.
    pub fn set_areas(&mut self, areas: [HiddenArea; 2]) {
        // The thread listens as long as this exists.
        let _ = self.requests.send(Request::Areas(areas));
        self.asked = None;
    }

    /// Asks for the masks of such images, unless that was the last thing asked for.
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

    #[test]
    fn masks_come_for_what_was_asked_last() {
        let fov = Fov { left: -1.0, right: 1.0, up: 1.0, down: -1.0 };
        let corner = HiddenArea { triangles: vec![[[-1.0, 1.0], [0.0, 1.0], [-1.0, 0.0]]] };
        let mut masks = Masks::default();
        // Without areas nothing comes.
        masks.ask([fov; 2], [[32, 32]; 2]);
        masks.set_areas([corner.clone(), corner]);
        masks.ask([fov; 2], [[64, 64]; 2]);
        masks.ask([fov; 2], [[32, 32]; 2]);
        let began = Instant::now();
        let got = loop {
            if let Some(got) = masks.take([[32, 32]; 2]) {
                break got;
            }
            assert!(began.elapsed() < Duration::from_secs(10), "no mask came");
            std::thread::yield_now();
        };
        assert_eq!(got[0].len(), 32);
        assert!(got[0][0] & 1 == 1 && got[0][31] == 0, "the top left corner is hidden");
        assert!(masks.take([[32, 32]; 2]).is_none(), "once");
    }
}
