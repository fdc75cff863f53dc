//! Every setting: the one place that says its key, type, default, range, unit, meaning, and whom it is for.

use super::kind::ValueKind;
use super::near::NearClip;
use super::setting::{Audience, Section, Setting, settings};
use crate::desktop::MirroredEyes;
use crate::walk::kind::ScanKind;
use crate::walk::moving::{Hand, Stride, Turn};
use crate::walk::start::EYE_HEIGHT_M;
use base::choice::Auto;
use lab::LodMethod;
use lab::order::Order;
use lab::technique::{EarlyZLoad, Method};
use points::{ColumnNames, Project, ReadOptions, Unit, Up};
use render::gpu::Atomics;
use render::options::{Dilate, Overlay, Precision, Quality};
use serde::{Deserialize, Serialize};

settings! {
    /// The GPU.
    gpu: GpuConfig {
        /// Part of the GPU's name, in any case; empty: the fastest kind there is. A headset's runtime chooses its own GPU.
        adapter: String = String::new();
        /// Largest part of the point pool that one binding holds; 0: as much as the GPU allows.
        chunk_mib: u32 = 0, in "MiB", for Laboratory;
        /// Which atomic operations the stages use; "auto": the best that the GPU has. All draw the same picture.
        tier: Auto<Atomics> = Auto(None), for Laboratory;
        /// How early-z loads the pixel that it looks at. Both draw the same picture.
        early_z_load: EarlyZLoad = EarlyZLoad::Atomic, for Laboratory;
        /// true: shaders check every index, as those of debug builds always do, to find faults. It is slower, and the
        /// picture is the same.
        bounds_checks: bool = false, for Laboratory;
    }

    /// How files are read.
    cloud: CloudConfig {
        /// Order of the points in memory. An octree has its own.
        order: Order = Order::Morton, for Laboratory;
        /// The axis of the files' coordinates that points up.
        up: Up = ReadOptions::AS_FILES_SAY.up;
        /// true: a file that cannot be read to its end is an error; false: a warning names it, and what can be read is
        /// shown.
        strict: bool = ReadOptions::AS_FILES_SAY.strict;
        /// The unit of the files' lengths: "auto" (as the files state it), "m", "mm", "cm", "ft", "us-ft" or a number of
        /// meters.
        unit: Unit = ReadOptions::AS_FILES_SAY.unit, from 1e-9 to 1e9, in "meters";
        /// The unit of the files' heights where it is not that of cloud.unit, written in the same way; heights are then
        /// scaled to the unit across.
        vertical_unit: Unit = ReadOptions::AS_FILES_SAY.vertical_unit, from 1e-9 to 1e9, in "meters";
        /// Which files have coordinates on the earth, and are drawn upright and in meters about the scan's middle.
        project: Project = ReadOptions::AS_FILES_SAY.project;
        /// true: points that their files flag as withheld, which means deleted, are drawn too.
        show_withheld: bool = ReadOptions::AS_FILES_SAY.show_withheld;
        /// The columns of text files, "x,y,z,r,g,b,i,-", "-" for one that is passed over; "" (as the files
        /// say, or as their values tell).
        columns: ColumnNames = ReadOptions::AS_FILES_SAY.columns;
    }

    /// How the frame is drawn.
    frame: FrameConfig {
        /// Points nearer than this are not drawn; in a picture it counts in units of the scan. "auto" is 0.05, and less in
        /// pictures of scenes smaller than 2.5 units.
        near_m: NearClip = NearClip::Auto, from 1e-6 to 1e6, in "meters";
        /// Color where no point is: red, green, blue, 0 to 255.
        background: [u8; 3] = [0, 0, 0];
        /// Coordinate bits that are read.
        precision: Precision = Precision::Auto;
        /// How points get into pixels, by the papers' names. All draw the same picture, except for those that are wrong, for
        /// hqs1 in pixels of too many points, and for point-list and fixed40 where points are equally far. prefetch and
        /// basic are of either quality, those that begin with hqs of that one, the others of the quality closest, whatever
        /// frame.quality says. point-list, reduce, reduce-early-z and dedup draw points of one pixel, whatever frame.fill
        /// says.
        method: Method = Method::Prefetch, for Laboratory;
        /// false: what neither eye sees is read too, to measure what that costs.
        cull: bool = true, for Laboratory;
        /// What a pixel shows of the points in it.
        quality: Quality = Quality::Hqs;
        /// How gaps between points are filled.
        dilate: Dilate = Dilate::Rings;
        /// true: where points lie further apart than the kernels of frame.dilate reach, the finest or what level of detail
        /// leaves, wider kernels close the gaps, and then points are drawn larger.
        fill: bool = true;
    }

    /// One fovea, in degrees from the gaze, for level of detail and dilation.
    fovea: FoveaConfig {
        /// Where the inner and the middle ring end.
        ring_deg: [f64; 2] = [20.0, 38.0], from 0 to 89, in "degrees";
        /// true: thresholds grow smoothly from ring to ring.
        smooth: bool = false;
    }

    /// Level of detail.
    lod: LodConfig {
        /// true: what matters is drawn; false: every point, always.
        enabled: bool = true;
        /// What is built to tell what matters.
        method: LodMethod = LodMethod::Octree, for Laboratory;
        /// A node of the octree is drawn if its projected edge has this many pixels: in the inner, middle and outer ring.
        // Below 50, a pixel could get more points than the stage `color` can add up: see `render::layout::Sums`.
        threshold_px: [f64; 3] = [100.0, 200.0, 300.0], from 50 to 10_000, in "pixels";
        /// true: points of a node of the octree appear one by one; false: all at once.
        fade: bool = true;
        /// A disc of the point tree is drawn in place of what it stands for if it is wrong by this many pixels at most
        /// where the eye looks; toward the edge of sight by as many times that as the last of lod.threshold_px is the
        /// first.
        error_px: f64 = lab::technique::DEFAULT_ERROR_PX, from 0.1 to 16, in "pixels", for Laboratory;
        /// true: discs of the point tree that show the eye their backs are left out. This is for scans whose files have
        /// normals or triangles, and right ones: where they point to the wrong side, the surface is not seen.
        cull_backfaces: bool = false, for Laboratory;
    }

    /// What keeps the frame within its time.
    governor: GovernorConfig {
        /// true: quality is given up when frames take too long: level of detail first, then resolution, then blending.
        enabled: bool = true;
        /// Share of the display period that the GPU may use; the runtime's compositor needs the rest.
        budget: f64 = 0.8, from 0.1 to 1;
    }

    /// The headset.
    headset: HeadsetConfig {
        /// Factor on the width and height that the runtime recommends for the eyes' images.
        resolution_scale: f64 = 1.0, from 0.05 to 4;
        /// Images a second that the headset is to show, where its runtime lets programs choose: the nearest that it
        /// offers; 0: as many as the runtime chooses.
        refresh_hz: f64 = 0.0, from 0 to 1000, in "hertz";
        /// true: the runtime gets depths where it takes them, for its reprojection.
        depth_layer: bool = true;
        /// true: pixels that the lenses hide are not filled, where the runtime tells which.
        visibility_mask: bool = true;
        /// true: hands without controllers are followed where the runtime tracks them.
        hands: bool = true;
    }

    /// What a walk shows where the scan has nothing. Pictures have frame.background there.
    surround: SurroundConfig {
        /// true: a calm surrounding; false: frame.background.
        show: bool = true;
        /// Color straight up: red, green, blue, 0 to 255.
        sky: [u8; 3] = [22, 26, 34];
        /// Color of the horizon.
        horizon: [u8; 3] = [54, 58, 66];
        /// Color straight down.
        ground: [u8; 3] = [28, 28, 30];
        /// true: lines a meter apart lie on the floor that the walk begins on.
        grid: bool = true;
        /// Color of the lines.
        line: [u8; 3] = [84, 88, 96];
    }

    /// The headset that stands in where there is none.
    simulated: SimulatedConfig {
        /// Size of each eye's image: width, height.
        size_px: [u32; 2] = [960, 1080], from 1 to 16_384, in "pixels";
        /// Half angles of the left eye's field of view: outwards, inwards, up, down. The right eye mirrors it.
        fov_deg: [f64; 4] = [45.0, 45.0, 45.0, 45.0], from -89 to 89, in "degrees";
        /// Distance between the eyes.
        eye_distance_m: f64 = 0.063, from 0 to 10, in "meters";
        /// Outward turn of each eye's display.
        cant_deg: f64 = 0.0, from -60 to 60, in "degrees";
        /// Displays a second; the frame's budget is one period.
        refresh_hz: f64 = 90.0, from 1 to 1000, in "hertz";
        /// Height of the eyes above the floor.
        eye_height_m: f64 = EYE_HEIGHT_M, from -1000 to 1000, in "meters";
    }

    /// Getting about.
    locomotion: LocomotionConfig {
        /// Speed at full stick or key; 0: chosen from the scan's size.
        speed: f64 = 0.0, from 0 to 1e6, in "meters a second";
        /// How many times as fast as that the user moves at first; wheel, keys and panel change it within its limits.
        speed_factor: f64 = 1.0, from 0.015625 to 64, in "times";
        /// What the scan is of, which decides where and how large one begins to see it; "auto": its size, its floor and its
        /// walls tell.
        seen_as: Auto<ScanKind> = Auto(None);
        /// Factor while the fast key is held.
        fast: f64 = 4.0, from 1 to 1000;
        /// How sticks and keys move at first.
        stride: Stride = Stride::Auto;
        /// The hand whose stick moves; the other hand's stick turns and teleports.
        moving_hand: Hand = Hand::Left;
        /// How the stick turns.
        turn: Turn = Turn::Snap;
        /// Angle of a snap turn.
        snap_deg: f64 = 30.0, from 1 to 180, in "degrees";
        /// Speed of a smooth turn at full stick.
        turn_deg_per_s: f64 = 90.0, from 1 to 720, in "degrees a second";
        /// How far a hand that points a little upwards teleports.
        reach_m: f64 = 8.0, from 0.5 to 100, in "meters";
        /// How far the edge of sight is darkened while a stick moves the user; 0: not at all.
        vignette: f64 = 0.5, from 0 to 1;
        /// true: the controllers' buttons are labeled for the first half minute; the menu shows the labels again.
        labels: bool = true;
        /// Angle that the view turns for each pixel that the mouse moves.
        look_deg_per_px: f64 = 0.15, from -10 to 10, in "degrees";
    }

    /// The desktop window.
    window: WindowConfig {
        /// Size at start: width, height.
        size: [u32; 2] = [1280, 720], from 1 to 16_384, in "points";
        /// What the window mirrors.
        mirror: MirroredEyes = MirroredEyes::Left;
        /// true: the panel is shown at start.
        panel: bool = true;
        /// true: the panel lists the scans that were opened last, which are kept in a file of the user's; false: none is kept.
        recent: bool = true;
        /// Drawn over the mirror, never in the headset, to see how a frame comes about.
        overlay: Overlay = Overlay::None;
    }
}
