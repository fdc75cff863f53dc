//! The stage in the world: where its floor lies, how it is turned about the vertical, and how large the scan is shown. The
//! horizon stays level, whatever happens. Turns and changes of scale are about the head or a hand, which stay where they
//! are.

use base::space::{Eye, Pose, View};
use glam::{DQuat, DVec2, DVec3};
use std::f64::consts::FRAC_PI_2;
use xr::StageEye;

/// The sine of the steepest gaze whose own direction tells where the head faces.
const STEEP: f64 = 0.9;

/// Where the stage stands in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StagePlace {
    /// The stage's origin, on its floor, in world space.
    pub floor_in_world: DVec3,
    /// Turn about the world's vertical, radians; 0 looks along +y (north), positive to the left.
    pub yaw: f64,
    /// Size at which the scan is shown: 1 is as large as life, 0.1 a model at 1:10.
    pub scale: f64,
    /// World units a meter of the user's where the scan is shown as large as life.
    life_units_per_m: f64,
}

/// Where somebody stands, wherever in the stage they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Standpoint {
    /// The floor below the head, in world space.
    pub floor_in_world: DVec3,
    /// Direction in which the head faces about the world's vertical, radians; see [`StagePlace::yaw`].
    pub yaw: f64,
    /// Size at which the scan is shown.
    pub scale: f64,
}

impl StagePlace {
    /// A stage as large as life.
    #[must_use]
    pub fn new(floor_in_world: DVec3, yaw: f64, life_units_per_m: f64) -> Self {
        Self { floor_in_world, yaw, scale: 1.0, life_units_per_m }
    }

    /// World units a meter of the user's.
    #[must_use]
    pub fn units_per_m(&self) -> f64 {
        self.life_units_per_m / self.scale
    }

    /// World units a meter of the user's where the scan is shown as large as life.
    #[must_use]
    pub fn life_units_per_m(&self) -> f64 {
        self.life_units_per_m
    }

    /// Rotation from stage axes (y up) to world axes (z up), turned by the yaw.
    #[must_use]
    pub fn world_from_stage_axes(&self) -> DQuat {
        DQuat::from_rotation_z(self.yaw) * DQuat::from_rotation_x(FRAC_PI_2)
    }

    /// Converts a place in the stage to one in the world.
    #[must_use]
    pub fn p_in_world(&self, p_in_stage: DVec3) -> DVec3 {
        self.floor_in_world + self.world_from_stage_axes() * p_in_stage * self.units_per_m()
    }

    /// Converts a place in the world to one in the stage.
    #[must_use]
    pub fn p_in_stage(&self, p_in_world: DVec3) -> DVec3 {
        self.world_from_stage_axes().inverse() * (p_in_world - self.floor_in_world) / self.units_per_m()
    }

    /// A place in the world as an upright pose in the stage, which is turned as the world is: its x axis is the world's x
    /// axis, its z axis the world's −y.
    #[must_use]
    pub fn stage_from_level(&self, p_in_world: DVec3) -> Pose {
        Pose { position: self.p_in_stage(p_in_world), orientation: DQuat::from_rotation_y(-self.yaw) }
    }

    /// Converts a pose in the stage to one in the world.
    #[must_use]
    pub fn pose_in_world(&self, stage_from: &Pose) -> Pose {
        let orientation = (self.world_from_stage_axes() * stage_from.orientation).normalize();
        Pose { position: self.p_in_world(stage_from.position), orientation }
    }

    /// Moves the stage so that a place in it comes to lie at one in the world.
    pub fn bring(&mut self, p_in_stage: DVec3, p_in_world: DVec3) {
        self.floor_in_world += p_in_world - self.p_in_world(p_in_stage);
    }

    /// Turns to the left by `angle` radians about a place in the stage: whoever stands off the stage's middle must not be
    /// swung round it.
    pub fn turn_about(&mut self, p_in_stage: DVec3, angle: f64) {
        let p_in_world = self.p_in_world(p_in_stage);
        self.yaw += angle;
        self.bring(p_in_stage, p_in_world);
    }

    /// Shows the scan at another size; a place in the stage stays where it is in the world.
    pub fn scale_about(&mut self, p_in_stage: DVec3, scale: f64) {
        let p_in_world = self.p_in_world(p_in_stage);
        self.scale = scale;
        self.bring(p_in_stage, p_in_world);
    }

    /// Direction in which a head of the stage faces, about the world's vertical.
    #[must_use]
    pub fn facing(&self, stage_from_head: &Pose) -> f64 {
        self.yaw + facing_in_stage(stage_from_head)
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
        let (head, units_per_m) = (head_of(eyes), self.units_per_m());
        let to_eye = |(eye, size_px): (&StageEye, [u32; 2])| {
            let mut head_from_view = head.inverse().then(&eye.stage_from_view);
            head_from_view.position *= units_per_m;
            Eye {
                world_from_view: world_from_head.then(&head_from_view),
                fov: eye.fov,
                size_px,
                gaze_in_view: eye.gaze_in_view.unwrap_or(Eye::AHEAD),
            }
        };
        View { eyes: eyes.iter().zip(sizes_px).map(to_eye).collect(), near: near_m * units_per_m }
    }

    /// Where somebody stands whose feet are `raised_m` meters above the stage's floor.
    #[must_use]
    pub fn standpoint(&self, stage_from_head: &Pose, raised_m: f64) -> Standpoint {
        let below = stage_from_head.position.with_y(-raised_m);
        Standpoint {
            floor_in_world: self.p_in_world(below),
            yaw: self.facing(stage_from_head),
            scale: self.scale,
        }
    }

    /// Brings the user to a standpoint, wherever in the stage their head is. The stage's floor is then `raised_m` meters
    /// above the floor there.
    pub fn stand(&mut self, at: &Standpoint, stage_from_head: &Pose, raised_m: f64) {
        self.scale = at.scale;
        self.yaw = at.yaw - facing_in_stage(stage_from_head);
        let below = stage_from_head.position.with_y(-raised_m);
        self.bring(below, at.floor_in_world);
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

/// Direction in which a head faces, about the stage's vertical: 0 along −z, positive to the left. Whoever looks straight
/// down or up faces where the top of the head, or the chin, points.
#[must_use]
pub fn facing_in_stage(stage_from_head: &Pose) -> f64 {
    let ahead = stage_from_head.orientation * DVec3::NEG_Z;
    let ahead = if ahead.y.abs() < STEEP {
        ahead
    } else {
        stage_from_head.orientation * DVec3::Y * -ahead.y.signum()
    };
    if DVec2::new(ahead.x, ahead.z).length() < 1e-6 { 0.0 } else { (-ahead.x).atan2(-ahead.z) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const UTM: DVec3 = DVec3::new(5e5, 4e6, 100.0);

    fn vec(range: f64) -> impl Strategy<Value = DVec3> {
        [-range..range, -range..range, -range..range].prop_map(DVec3::from_array)
    }

    fn pose() -> impl Strategy<Value = Pose> {
        (vec(3.0), vec(1.0), 0.0..6.0).prop_filter_map("no axis", |(position, axis, angle)| {
            let axis = axis.try_normalize()?;
            Some(Pose { position, orientation: DQuat::from_axis_angle(axis, angle) })
        })
    }

    fn place() -> impl Strategy<Value = StagePlace> {
        (vec(100.0), -4.0..4.0, 0.01..20.0, 0.3..4.0).prop_map(|(floor, yaw, scale, units_per_m)| {
            StagePlace { scale, ..StagePlace::new(UTM + floor, yaw, units_per_m) }
        })
    }

    proptest! {
        #[test]
        fn turns_and_scales_leave_the_head_where_it_is(
            mut place in place(), head in vec(3.0), angle in -7.0..7.0, scale in 0.01..20.0
        ) {
            let before = place.p_in_world(head);
            place.turn_about(head, angle);
            place.scale_about(head, scale);
            prop_assert_eq!(place.scale, scale);
            // Coordinates of several millions have steps of a nanometer.
            prop_assert!((place.p_in_world(head) - before).length() < 1e-7);
        }

        #[test]
        fn places_go_to_the_world_and_back(place in place(), p in vec(5.0)) {
            prop_assert!((place.p_in_stage(place.p_in_world(p)) - p).length() < 1e-7);
            let level = place.stage_from_level(place.p_in_world(p));
            prop_assert!((level.position - p).length() < 1e-7);
            // A step along the pose's x axis is one along the world's.
            let along = place.p_in_world(p + level.orientation * DVec3::X) - place.p_in_world(p);
            prop_assert!((along - DVec3::X * place.units_per_m()).length() < 1e-6);
        }

        #[test]
        fn whoever_is_brought_somewhere_stands_there_and_faces_as_asked(
            mut place in place(), head in pose(), floor in vec(50.0), yaw in -3.0..3.0, raised in -1.0..1.0
        ) {
            let at = Standpoint { floor_in_world: UTM + floor, yaw, scale: 0.5 };
            place.stand(&at, &head, raised);
            let stands = place.standpoint(&head, raised);
            prop_assert!((stands.floor_in_world - at.floor_in_world).length() < 1e-7);
            prop_assert!((stands.yaw - yaw).abs() < 1e-9 && stands.scale == 0.5);
            let head_in_world = place.p_in_world(head.position);
            let height = (head.position.y + raised) * place.units_per_m();
            prop_assert!((head_in_world - at.floor_in_world - DVec3::Z * height).length() < 1e-7);
            // Up in the stage is up in the world.
            prop_assert!((place.world_from_stage_axes() * DVec3::Y - DVec3::Z).length() < 1e-12);
        }
    }

    #[test]
    fn heads_face_where_they_look_and_keep_facing_there_when_they_look_down() {
        let facing = |yaw: f64, pitch: f64| {
            let orientation = DQuat::from_rotation_y(yaw) * DQuat::from_rotation_x(pitch);
            facing_in_stage(&Pose { position: DVec3::ZERO, orientation })
        };
        for yaw in [-3.0, -1.0, 0.0, 0.5, 3.1] {
            for pitch in [-FRAC_PI_2, -1.4, -0.5, 0.0, 0.9, 1.3, FRAC_PI_2] {
                assert!((facing(yaw, pitch) - yaw).abs() < 1e-9, "{yaw} {pitch}: {}", facing(yaw, pitch));
            }
        }
        let west = StagePlace::new(DVec3::ZERO, FRAC_PI_2, 1.0);
        assert!((west.facing(&Pose::IDENTITY) - FRAC_PI_2).abs() < 1e-12);
    }

    #[test]
    fn a_model_at_one_to_ten_has_ten_meters_in_one() {
        let mut place = StagePlace::new(UTM, 0.0, 1.0 / 0.3048);
        place.scale_about(DVec3::ZERO, 0.1);
        assert!((place.units_per_m() - 10.0 / 0.3048).abs() < 1e-9);
        let north = place.p_in_world(DVec3::NEG_Z) - UTM;
        assert!((north - DVec3::Y * 10.0 / 0.3048).length() < 1e-8);
    }
}
