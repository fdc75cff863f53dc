//! What a frame loop asks of a headset, whether an OpenXR runtime stands behind it or a simulation.

use crate::controllers::Profile;
use crate::fault::End;
use crate::hidden_area::HiddenArea;
use base::space::{Fov, Pose};
use glam::DVec3;
use std::time::Duration;
use timing::CallTimes;

/// What the headset wants next.
#[derive(Clone, Debug, PartialEq)]
pub enum FrameState {
    /// Draw a frame (or, with `should_render` false, only keep the runtime's rhythm).
    Frame {
        /// Predicted display time, nanoseconds of the headset's clock.
        predicted_display_ns: i64,
        /// Nanoseconds between two displays.
        period_ns: i64,
        /// False if nobody would see the frame.
        should_render: bool,
    },
    /// There is no frame just now: no session runs, or the runtime failed in this one. Ask again.
    Idle,
    /// The session is over.
    Ended(End),
}

/// An eye as the headset reports it, in stage space (meters, y up).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageEye {
    /// Pose of the eye in the stage.
    pub stage_from_view: Pose,
    /// Field of view of the eye.
    pub fov: Fov,
    /// Direction of the gaze in view space, unit length; `None` if nobody tracks it.
    pub gaze_in_view: Option<DVec3>,
}

/// A hand in one frame: where it is, and what it holds down.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HandInput {
    /// The hand's pointing ray starts here and goes along −z. In stage space, at the frame's display time; `None` while
    /// nobody knows where the hand is.
    pub stage_from_aim: Option<Pose>,
    /// The middle of what the hand holds, as OpenXR has it. In stage space; `None` while nobody knows.
    pub stage_from_grip: Option<Pose>,
    /// Stick: x right, y forward, each −1 to 1. A trackpad counts while it is pressed.
    pub stick: [f32; 2],
    /// True if the hand has a stick or trackpad. Bare hands and the simplest controllers have none: `select` is all that
    /// they can move by.
    pub has_stick: bool,
    /// The kind of controller that the hand holds; `None` if it holds none, or the runtime does not tell.
    pub profile: Option<&'static Profile>,
    /// True while the trigger is pressed, or thumb and finger are pinched.
    pub select: bool,
    /// True while the hand grabs.
    pub grab: bool,
    /// True while the menu button is pressed, or a bare hand pinches with its palm to the eyes.
    pub menu: bool,
    /// True while the button that leads back to the start is pressed.
    pub reset: bool,
}

/// Input of both hands in one frame; the simulated headset leaves it at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ControllerInput {
    /// Left, right.
    pub hands: [HandInput; 2],
}

/// A joint of a hand that is tracked without a controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Pose of the joint in stage space, at the frame's display time. Its −z axis points to the fingertip, its y axis out
    /// of the back of the hand.
    pub stage_from_joint: Pose,
    /// Distance from the joint to the skin, meters.
    pub radius_m: f64,
}

impl Default for Joint {
    /// A point at the stage's origin.
    fn default() -> Self {
        Self { stage_from_joint: Pose::IDENTITY, radius_m: 0.0 }
    }
}

/// The joints of a hand, in OpenXR's order (XrHandJointEXT); [`joint`] names some of them.
pub type HandJoints = [Joint; 26];

/// Numbers of joints in [`HandJoints`].
///
/// The thumb has the joints 2 to 5 and the fingers 6 to 10, 11 to 15, 16 to 20 and 21 to 25, each from the wrist to the tip.
pub mod joint {
    /// The middle of the palm.
    pub const PALM: usize = 0;
    /// The wrist.
    pub const WRIST: usize = 1;
    /// Tip of the thumb.
    pub const THUMB_TIP: usize = 5;
    /// Knuckle of the index finger.
    pub const INDEX_PROXIMAL: usize = 7;
    /// Tip of the index finger.
    pub const INDEX_TIP: usize = 10;
    /// Tip of the middle finger.
    pub const MIDDLE_TIP: usize = 15;
    /// Tip of the ring finger.
    pub const RING_TIP: usize = 20;
    /// Tip of the little finger.
    pub const LITTLE_TIP: usize = 25;
}

/// The images of one frame, left then right; the frame fills both kinds.
#[derive(Clone, Debug)]
pub struct EyeImages {
    /// What the eyes see.
    pub color: [wgpu::Texture; 2],
    /// Depth images, if the headset takes them: as large as `color`, to be rendered to. A pixel holds near ÷ depth,
    /// where depth is the linear one (w) and near that of the settings (`frame.near_m`), both in one unit: 1 at the
    /// near plane, 0 infinitely far away and where nothing is.
    pub depth: Option<[wgpu::Texture; 2]>,
}

/// A picture that is seen as a rectangle in the stage.
#[derive(Clone, Debug, PartialEq)]
pub struct Panel {
    /// The picture; another one each time that it changes. It can be copied from.
    pub picture: wgpu::Texture,
    /// Pose of its middle: x to its right, y up, z out of it towards the viewer.
    pub stage_from_panel: Pose,
    /// Width, height in meters.
    pub size_m: [f64; 2],
}

/// A headset: the runtime's side of the frame loop. All calls come from the frame thread, in this order
/// a frame: `wait`, `input`, `acquire`, (record), `locate`, `submit`.
///
/// No call fails. What goes wrong with one frame costs that frame. What ends the session is told by the next `wait`, as
/// [`FrameState::Ended`]; until then the other calls do nothing.
pub trait Headset: Send {
    /// For the log: "Monado(XRT) 25.0.0", "simulated".
    fn runtime(&self) -> String;
    /// Width, height of each eye's image, left then right.
    fn eye_sizes(&self) -> [[u32; 2]; 2];
    /// Displays a second.
    fn refresh_hz(&self) -> f64;
    /// Texture format of the images.
    fn image_format(&self) -> wgpu::TextureFormat;
    /// Texture format of the depth images; `None`: the headset takes none, and [`EyeImages::depth`] is `None`.
    fn depth_format(&self) -> Option<wgpu::TextureFormat> {
        None
    }
    /// What the lenses hide, left then right, when that is new: with the first frame, and after a change. It is always
    /// `None` if the headset does not tell, or is not to be asked.
    fn hidden_area(&mut self) -> Option<[HiddenArea; 2]> {
        None
    }
    /// True for the simulated one: its images outlast `submit`, so the mirror needs no copy, and the mouse may
    /// pitch its head, which would make people sick in a real one.
    fn is_simulated(&self) -> bool {
        false
    }
    /// Sets how many pixels of each image are drawn from the next `submit` on, from the top left corner; the display
    /// stretches them over the whole view. At first all pixels are drawn.
    fn set_drawn_px(&mut self, _drawn_px: [[u32; 2]; 2]) {}
    /// Handles events, then blocks until the next frame should begin.
    fn wait(&mut self) -> FrameState;
    /// Input of both hands: buttons as of now, poses at the frame's predicted display time; at rest if it cannot be had.
    fn input(&mut self) -> ControllerInput;
    /// The joints of each hand, left then right, as of the last `input`. `None` for a hand that is not seen, and always if
    /// the headset tracks no hands.
    fn hands(&self) -> [Option<HandJoints>; 2] {
        [None; 2]
    }
    /// Shakes a controller, 0 left or 1 right, with `strength` between 0 and 1 for `seconds`. A hand without a motor feels
    /// nothing.
    fn vibrate(&mut self, _hand: usize, _strength: f32, _seconds: f32) {}
    /// Shows a panel with the frames from now on, or none. False if the headset cannot: then it is to be drawn into the eyes'
    /// images.
    fn show_panel(&mut self, panel: Option<&Panel>) -> bool {
        panel.is_none()
    }
    /// The eyes' images to draw into, valid until `submit`; `None` if they cannot be had: then the frame is submitted
    /// without commands.
    fn acquire(&mut self) -> Option<EyeImages>;
    /// The eyes at the frame's predicted display time, or where they were last. Called as late as possible.
    fn locate(&mut self) -> [StageEye; 2];
    /// Hands the recorded commands to the GPU and the images to the display. `None`: nothing was drawn, because
    /// `should_render` was false or there were no images.
    fn submit(&mut self, commands: Option<wgpu::CommandEncoder>);
    /// What the last frame's calls took, to be asked after `submit`.
    fn call_times(&self) -> CallTimes {
        CallTimes::default()
    }
    /// State of the session, for the log: "FOCUSED".
    fn session(&self) -> &'static str {
        "simulated"
    }
    /// Asks the runtime to end the session; `wait` then returns [`FrameState::Ended`] in time.
    fn request_exit(&mut self);
    /// How long an idle loop should sleep before it asks again.
    fn idle_pause(&self) -> Duration {
        Duration::from_millis(20)
    }
}
