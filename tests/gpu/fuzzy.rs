//! The depth test with a tolerance and running average that point trees ask of future hardware [SPT §5], against
//! high-quality shading, which does the same in two dispatches.

use cloud::spt::SequentialCloud;
use kit::frames::{Canvas, discs, gpu, hqs, inside, made_up, spt_of};
use lab::reference::clear;
use lab::reference::points::{self, Put};
use lab::reference::tree::Tree;
use lab::synth::SynthKind;
use lab::technique::tree::TreeUniform;
use render::layout::{SURFACE_TOLERANCE, ViewUniform, guarded, without_guard};

const SIZE_PX: [u32; 2] = [301, 299];
const BLACK: u32 = 255 << 24;

/// A pixel of the proposed hardware: color and alpha, which counts, since all splats are opaque here.
#[derive(Clone, Copy, Default)]
struct Destination {
    rgb: [f64; 3],
    alpha: f64,
    z: f32,
}

impl Destination {
    /// Blends by the paper's rule. The paper's tolerance is a length; here it is a share of the depth, as in the
    /// frame.
    fn blend(&mut self, color: u32, z: f32) {
        let rgb = [0, 8, 16].map(|shift| f64::from(color >> shift & 255));
        if self.alpha == 0.0 || SURFACE_TOLERANCE * z < self.z {
            *self = Self { rgb, alpha: 1.0, z };
        } else if z <= SURFACE_TOLERANCE * self.z {
            let mean = |c: usize| (self.alpha * self.rgb[c] + rgb[c]) / (self.alpha + 1.0);
            *self = Self { rgb: std::array::from_fn(mean), alpha: self.alpha + 1.0, ..*self };
        }
    }

    /// Largest difference in a channel.
    fn difference(&self, color: u32) -> f64 {
        let channels = [0, 8, 16].map(|shift| f64::from(color >> shift & 255)).into_iter().zip(self.rgb);
        channels.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }
}

/// What an eye's pixels get if `fragments` come one after the other.
fn drawn(spt: &SequentialCloud, fragments: &[Put], eye: usize) -> Vec<Destination> {
    let mut pixels = clear::pixels(guarded(SIZE_PX), Destination::default());
    for put in fragments.iter().filter(|put| put.eye == eye) {
        pixels[put.pixel].blend(spt.cloud.colors[(put.id >> 1) as usize], put.w);
    }
    without_guard(&pixels, SIZE_PX)
}

/// The two are the same except for rounding if the nearest point comes first. In the list's order they differ where
/// the nearest comes late: a point up to a tolerance behind another that was in front at the time is blended in,
/// where `hqs` counts from the nearest. The proposal depends on the order, `hqs` does not.
#[test]
fn fuzzy_blending_is_high_quality_shading() {
    let spt = spt_of(&made_up(SynthKind::Terrestrial, 200_000), false);
    let view = inside(SIZE_PX);
    let detail = discs();
    let options = hqs(detail);
    let frame = Canvas::sequential(&spt, 1.0, &view, options, gpu().atomics(), 0).draw(&view);

    let uniform = ViewUniform::new(&view, &spt.cloud.split, &detail);
    let tree = TreeUniform::new(&view, &detail, 1.0, spt.scale.base);
    let tree = Tree { uniform: tree, ..Tree::new(&spt) };
    let mut fragments: Vec<Put> = Vec::new();
    let planes = spt.cloud.planes.each_ref().map(Vec::as_slice);
    points::points(&uniform, 2, &frame.visible, planes, Some(&tree), true, &mut |put| fragments.push(put));
    let in_order = [0, 1].map(|eye| drawn(&spt, &fragments, eye));
    fragments.sort_by(|a, b| a.w.total_cmp(&b.w));
    let nearest_first = [0, 1].map(|eye| drawn(&spt, &fragments, eye));

    let (mut num_drawn, mut num_other, mut sum) = (0, 0, 0.0);
    for eye in 0..2 {
        for (pixel, shown) in frame.surface[eye].iter().enumerate() {
            let [depth, color] = *shown;
            let fuzzy = nearest_first[eye][pixel];
            assert_eq!(depth == u32::MAX, fuzzy.alpha == 0.0);
            if depth == u32::MAX {
                continue;
            }
            num_drawn += 1;
            assert_eq!(depth, fuzzy.z.to_bits());
            // Colors are stored as whole numbers.
            assert!(fuzzy.difference(color) <= 0.5 + 1e-9, "eye {eye}, pixel {pixel}");
            let late = in_order[eye][pixel].difference(color);
            num_other += u32::from(late > 0.5 + 1e-9);
            sum += late;
        }
    }
    let (share, mean) = (f64::from(num_other) / f64::from(num_drawn), sum / f64::from(num_drawn));
    println!(
        "{num_drawn} pixels; in the list's order {share:.3} differ, the mean difference is {mean:.2} of 255"
    );
    assert!(num_drawn > 100_000);
    assert!(share > 0.01, "the comparison can fail: another order is another picture");
    assert!(mean < 4.0, "{mean}");
    assert!(nearest_first[0].iter().any(|pixel| pixel.difference(BLACK) > 100.0));
}
