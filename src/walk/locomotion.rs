//! Getting about: where the stage (the headset's play space) stands in the world, and how sticks, keys and mouse
//! move it. Pure arithmetic in f64; the frame thread calls it once a frame.

use super::state::Action;
use base::space::{Eye, Pose, View};
use glam::{DQuat, DVec3};
use std::f64::consts::FRAC_PI_2;
use timing::Place;
use xr::{ControllerInput, StageEye};

/// Stick deflection below this is noise.
const DEAD_ZONE: f32 = 0.15;
/// A snap turn fires when the stick passes this, and again only after it came back below half.
const SNAP_AT: f32 = 0.7;

/// How sticks, keys and mouse move the viewer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LocomotionOptions {
    /// Meters a second at full stick or key; `None`: chosen from the scan's size.
    pub speed_m_per_s: Option<f64>,
    /// Factor while the fast key is held.
    pub fast: f64,
    /// Radians of a snap turn.
    pub snap_rad: f64,
    /// Radians that the view turns for each pixel that the mouse moves.
    pub look_rad_per_px: f64,
}

/// Where a walk begins, in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// The floor below the viewer.
    pub floor_in_world: DVec3,
    /// Direction of view about the world's vertical, radians; 0 looks along +y (north), positive to the left.
    pub yaw: f64,
    /// World units a meter.
    pub units_per_m: f64,
    /// Factor by which the scan is shown larger than it is, as by a magnifying glass.
    pub magnified: f64,
    /// Longest horizontal extent of the scan in meters: it sets the default speed.
    pub extent_m: f64,
    /// Place and yaw from which the whole scan is seen.
    pub overview: (DVec3, f64),
}

/// The stage in the world, and the speed.
#[derive(Clone, Debug)]
pub struct Locomotion {
    options: LocomotionOptions,
    start: Start,
    floor_in_world: DVec3,
    yaw: f64,
    /// Pitch of the view. It stays 0 for real headsets: a head pitches itself.
    pitch: f64,
    may_pitch: bool,
    /// The head's place in the stage, as last located; turns are about it.
    head_in_stage: DVec3,
    held: ([f32; 3], bool),
    snap_ready: bool,
}

impl Locomotion {
    /// A viewer who stands at the start.
    #[must_use]
    pub fn new(options: LocomotionOptions, start: Start) -> Self {
        Self {
            options,
            start,
            floor_in_world: start.floor_in_world,
            yaw: start.yaw,
            pitch: 0.0,
            may_pitch: false,
            head_in_stage: DVec3::ZERO,
            held: ([0.0; 3], false),
            snap_ready: true,
        }
    }

    /// Sets whether the mouse may look up and down, which is for simulated headsets only: a head pitches itself.
    pub fn set_may_pitch(&mut self, may_pitch: bool) {
        self.may_pitch = may_pitch;
        if !may_pitch {
            self.pitch = 0.0;
        }
    }

    /// Meters a second at full deflection, until the user changes it.
    #[must_use]
    pub fn speed(&self) -> f64 {
        // One moves slowly round a small object.
        let extent_m = self.start.extent_m;
        let chosen = (0.1 * extent_m).clamp(extent_m.clamp(0.1, 1.0), 60.0);
        self.options.speed_m_per_s.unwrap_or(chosen)
    }

    /// Where the stage stands, for the log.
    #[must_use]
    pub fn place(&self) -> Place {
        let units_per_m = self.start.units_per_m;
        Place { floor_in_world: self.floor_in_world, yaw_deg: self.yaw.to_degrees(), units_per_m }
    }

    /// Applies what moves the viewer.
    pub fn apply(&mut self, action: Action) {
        match action {
            Action::Move { direction, fast } => self.held = (direction, fast),
            Action::Look { delta_px } => {
                let radians = self.options.look_rad_per_px;
                self.turn(-f64::from(delta_px[0]) * radians);
                if self.may_pitch {
                    self.pitch = (self.pitch - f64::from(delta_px[1]) * radians).clamp(-FRAC_PI_2, FRAC_PI_2);
                }
            }
            Action::Snap(steps) => self.turn(-f64::from(steps) * self.options.snap_rad),
            Action::Reset => self.reset(),
            Action::WholeView => {
                (self.floor_in_world, self.yaw) = self.start.overview;
                self.pitch = 0.0;
            }
            // The state applies these, or the walk.
            Action::Faster(_) | Action::SetSpeed(_) | Action::SetOverlay(_) | Action::NextOverlay => {}
            Action::Screenshot | Action::Quit => {}
        }
    }

    /// Turns to the left by `angle` about the head: whoever stands off the stage's middle must not be swung round it.
    fn turn(&mut self, angle: f64) {
        let scale = self.start.units_per_m;
        let before = self.world_from_stage_axes() * self.head_in_stage;
        self.yaw += angle;
        let after = self.world_from_stage_axes() * self.head_in_stage;
        self.floor_in_world += (before - after) * scale;
    }

    fn reset(&mut self) {
        (self.floor_in_world, self.yaw, self.pitch) = (self.start.floor_in_world, self.start.yaw, 0.0);
    }

    /// Moves by what is held for `seconds`, `faster` times as fast as [`Self::speed`]. `stage_from_head` is the head
    /// as last located: forward is the direction in which it looks.
    pub fn advance(
        &mut self,
        seconds: f64,
        faster: f32,
        controllers: &ControllerInput,
        stage_from_head: &Pose,
    ) {
        self.head_in_stage = stage_from_head.position;
        let dead = |v: f32| if v.abs() < DEAD_ZONE { 0.0 } else { f64::from(v) };
        let [right, up, forward] = self.held.0.map(f64::from);
        let [stick_right, stick_forward] = controllers.left_stick.map(dead);
        let fast = if self.held.1 { self.options.fast } else { 1.0 };
        let direction = DVec3::new(right * fast + stick_right, 0.0, -(forward * fast + stick_forward));
        let in_world = self.world_from_head(stage_from_head).orientation * direction + DVec3::Z * up * fast;
        // A hitch of the program must not throw the viewer through a wall.
        let step = self.speed() * f64::from(faster) * self.start.units_per_m * seconds.clamp(0.0, 0.1);
        self.floor_in_world += in_world * step;

        let turn = controllers.right_stick[0];
        if turn.abs() < 0.5 * SNAP_AT {
            self.snap_ready = true;
        } else if turn.abs() > SNAP_AT && self.snap_ready {
            self.snap_ready = false;
            self.turn(-f64::from(turn.signum()) * self.options.snap_rad);
        }
        if controllers.reset {
            self.reset();
        }
    }

    /// Rotation from stage axes (y up) to world axes (z up), turned by the yaw.
    fn world_from_stage_axes(&self) -> DQuat {
        DQuat::from_rotation_z(self.yaw) * DQuat::from_rotation_x(FRAC_PI_2)
    }

    /// The head in the world. The pitch turns it about itself, not about the stage's origin.
    #[must_use]
    pub fn world_from_head(&self, stage_from_head: &Pose) -> Pose {
        let turn = self.world_from_stage_axes();
        let pitch = DQuat::from_rotation_x(self.pitch);
        Pose {
            position: self.floor_in_world + turn * stage_from_head.position * self.start.units_per_m,
            orientation: (turn * stage_from_head.orientation * pitch).normalize(),
        }
    }

    /// The eyes in the world with the head at `world_from_head`, the user's or a pose path's. `near_m` is in meters.
    #[must_use]
    pub fn view(
        &self,
        world_from_head: &Pose,
        eyes: &[StageEye; 2],
        sizes_px: [[u32; 2]; 2],
        near_m: f64,
    ) -> View {
        let (head, scale) = (head_of(eyes), self.start.units_per_m);
        let to_eye = |(eye, size_px): (&StageEye, [u32; 2])| {
            let mut head_from_view = head.inverse().then(&eye.stage_from_view);
            head_from_view.position *= scale;
            Eye {
                world_from_view: world_from_head.then(&head_from_view),
                fov: eye.fov,
                size_px,
                gaze_in_view: eye.gaze_in_view.unwrap_or(Eye::AHEAD),
            }
        };
        View { eyes: eyes.iter().zip(sizes_px).map(to_eye).collect(), near: near_m * scale }
    }
}

/// The head: midway between the eyes, looking in the mean direction of the left and right eye.
#[must_use]
pub fn head_of(eyes: &[StageEye; 2]) -> Pose {
    let [left, right] = eyes.map(|e| e.stage_from_view);
    Pose {
        position: 0.5 * (left.position + right.position),
        orientation: left.orientation.slerp(right.orientation, 0.5),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use base::space::Fov;
    use std::f64::consts::PI;

    const OPTIONS: LocomotionOptions = LocomotionOptions {
        speed_m_per_s: None,
        fast: 4.0,
        snap_rad: PI / 6.0,
        look_rad_per_px: PI / 1200.0,
    };

    fn start() -> Start {
        Start {
            floor_in_world: DVec3::new(5e5, 4e6, 100.0),
            yaw: 0.0,
            units_per_m: 1.0,
            magnified: 1.0,
            extent_m: 20.0,
            overview: (DVec3::new(5e5, 4e6 - 50.0, 120.0), 0.0),
        }
    }

    fn eyes() -> [StageEye; 2] {
        let eye = |x| StageEye {
            stage_from_view: Pose { position: DVec3::new(x, 1.7, 0.0), orientation: DQuat::IDENTITY },
            fov: Fov::symmetric(1.5, 1.0),
            gaze_in_view: None,
        };
        [eye(-0.03), eye(0.03)]
    }

    fn walk() -> Locomotion {
        let mut walk = Locomotion::new(OPTIONS, start());
        walk.set_may_pitch(true);
        walk
    }

    fn seen(walk: &Locomotion, eyes: &[StageEye; 2]) -> View {
        walk.view(&walk.world_from_head(&head_of(eyes)), eyes, [[100, 100]; 2], 0.05)
    }

    #[test]
    fn stands_on_the_floor_looking_north_with_the_left_eye_in_the_west() {
        let view = seen(&walk(), &eyes());
        let [left, right] = [0, 1].map(|i| view.eyes[i].world_from_view);
        assert!((left.position - DVec3::new(5e5 - 0.03, 4e6, 101.7)).length() < 1e-9);
        assert!((right.position - DVec3::new(5e5 + 0.03, 4e6, 101.7)).length() < 1e-9);
        assert!((left.orientation * DVec3::NEG_Z - DVec3::Y).length() < 1e-12);
        assert!((left.orientation * DVec3::Y - DVec3::Z).length() < 1e-12);
    }

    #[test]
    fn eyes_look_where_they_are_seen_to_look_or_ahead() {
        let [mut left, right] = eyes();
        let aside = DVec3::new(0.6, 0.0, -0.8);
        left.gaze_in_view = Some(aside);
        let view = seen(&walk(), &[left, right]);
        assert_eq!([0, 1].map(|i| view.eyes[i].gaze_in_view), [aside, Eye::AHEAD]);
    }

    #[test]
    fn units_scale_the_viewer_not_the_scan() {
        let walk = Locomotion::new(OPTIONS, Start { units_per_m: 1.0 / 0.3048, ..start() });
        let view = seen(&walk, &eyes());
        let gap = view.eyes[1].world_from_view.position.x - view.eyes[0].world_from_view.position.x;
        assert!((gap - 0.06 / 0.3048).abs() < 1e-9 && (view.near - 0.05 / 0.3048).abs() < 1e-9);
    }

    #[test]
    fn the_left_stick_flies_where_the_head_looks() {
        let mut walk = walk();
        let forward = ControllerInput { left_stick: [0.0, 1.0], ..Default::default() };
        // The head looks left (west) and up by 45 degrees.
        let orientation = DQuat::from_rotation_y(FRAC_PI_2) * DQuat::from_rotation_x(FRAC_PI_2 / 2.0);
        walk.advance(0.1, 1.0, &forward, &Pose { position: DVec3::ZERO, orientation });
        let moved = walk.floor_in_world - start().floor_in_world;
        let step = 0.1 * walk.speed();
        assert!(
            (moved - DVec3::new(-step / 2f64.sqrt(), 0.0, step / 2f64.sqrt())).length() < 1e-9,
            "{moved}"
        );
    }

    #[test]
    fn the_right_stick_turns_once_a_push() {
        let mut walk = walk();
        let push = ControllerInput { right_stick: [1.0, 0.0], ..Default::default() };
        for _ in 0..5 {
            walk.advance(0.01, 1.0, &push, &Pose::IDENTITY);
        }
        assert!((walk.yaw + 30f64.to_radians()).abs() < 1e-12, "one snap to the right");
        walk.advance(0.01, 1.0, &ControllerInput::default(), &Pose::IDENTITY);
        walk.advance(0.01, 1.0, &push, &Pose::IDENTITY);
        assert!((walk.yaw + 60f64.to_radians()).abs() < 1e-12);
        walk.advance(0.01, 1.0, &ControllerInput { reset: true, ..Default::default() }, &Pose::IDENTITY);
        assert_eq!(walk.yaw, 0.0);
    }

    #[test]
    fn turning_leaves_the_head_where_it_is() {
        let mut walk = walk();
        let mut off_center = eyes();
        for eye in &mut off_center {
            eye.stage_from_view.position += DVec3::new(0.8, 0.0, -1.2);
        }
        walk.advance(0.01, 1.0, &ControllerInput::default(), &head_of(&off_center));
        let before = seen(&walk, &off_center).head_in_world();
        walk.apply(Action::Snap(3));
        let after = seen(&walk, &off_center);
        assert!((after.head_in_world() - before).length() < 1e-9);
        let forward = after.eyes[0].world_from_view.orientation * DVec3::NEG_Z;
        assert!((forward - DVec3::X).length() < 1e-9, "three times 30 degrees to the right: east");
    }

    #[test]
    fn the_mouse_never_pitches_a_real_head() {
        let mut walk = walk();
        walk.apply(Action::Look { delta_px: [0.0, -100.0] });
        walk.set_may_pitch(false);
        walk.apply(Action::Look { delta_px: [0.0, -200.0] });
        let view = seen(&walk, &eyes());
        assert!((view.eyes[0].world_from_view.orientation * DVec3::NEG_Z).z.abs() < 1e-12);
    }

    #[test]
    fn noise_of_a_stick_and_a_hitch_do_nothing_bad() {
        let mut walk = walk();
        walk.advance(
            0.1,
            1.0,
            &ControllerInput { left_stick: [0.1, -0.1], ..Default::default() },
            &Pose::IDENTITY,
        );
        assert_eq!(walk.floor_in_world, start().floor_in_world);
        walk.apply(Action::Move { direction: [0.0, 0.0, 1.0], fast: true });
        walk.advance(60.0, 1.0, &ControllerInput::default(), &Pose::IDENTITY);
        let moved = (walk.floor_in_world - start().floor_in_world).length();
        assert!((moved - 0.1 * 4.0 * walk.speed()).abs() < 1e-6, "a tenth of a second at most");
    }

    #[test]
    fn looking_up_turns_the_eyes_about_the_head() {
        let mut walk = walk();
        walk.apply(Action::Look { delta_px: [0.0, -200.0] });
        let view = seen(&walk, &eyes());
        assert!((view.head_in_world() - DVec3::new(5e5, 4e6, 101.7)).length() < 1e-9);
        let forward = view.eyes[0].world_from_view.orientation * DVec3::NEG_Z;
        assert!((forward.z - 30f64.to_radians().sin()).abs() < 1e-9, "{forward}");
    }
}
