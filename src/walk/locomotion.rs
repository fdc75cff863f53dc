//! Getting about: what sticks, hands, keys and mouse do to the stage's place in the world, frame by frame. Pure arithmetic in
//! f64; the parts are in `moving`.

use super::action::{Action, Stance};
use super::kind::ScanKind;
use super::moving::arc::{self, Ground, Landing};
use super::moving::feet::Feet;
use super::moving::floors::{Floors, FloorsCell};
use super::moving::gestures::{Gestures, Intents};
use super::moving::grab::Grab;
use super::moving::guides::{Event, Guides};
use super::moving::options::Stride;
use super::moving::place::{StagePlace, Standpoint};
use super::moving::visits::Visits;
use super::moving::{Vignette, model};
use base::space::Pose;
use glam::{DQuat, DVec2, DVec3};
use std::f64::consts::FRAC_PI_2;
use timing::Place;
use xr::{ControllerInput, StageEye};

mod around;

pub use super::moving::options::LocomotionOptions;
pub use super::moving::place::head_of;
pub use super::start::{Start, StartsCell};

/// Whoever is nearer than this to where the walk began, meters, has not left it.
const BEGUN_M: f64 = 0.01;
/// Longest time that a frame moves the user for, seconds: a hitch of the program must not throw them through a wall.
const LONGEST_FRAME_S: f64 = 0.1;
/// Most that one walks in a second, meters, unless the user says so.
const WALK_M_PER_S: f64 = 2.5;
/// Least scale at which feet follow the floor: a giant steps over it.
const LEAST_WALKED: f64 = 0.5;
/// Height of the eyes of somebody who stands, meters.
const STANDING_EYE_M: f64 = 1.65;
/// Most that the user may be raised or lowered, meters.
const MOST_RAISED_M: f64 = 2.0;
/// Length of the ray that points into a model, meters.
const POINTED_M: f64 = 30.0;

/// How the user gets about.
#[derive(Clone, Debug)]
pub struct Locomotion {
    options: LocomotionOptions,
    start: Start,
    /// What the user has said since that the scan is of.
    said: Option<ScanKind>,
    /// The starts of other kinds that the scan may be taken for.
    starts: StartsCell,
    place: StagePlace,
    /// Pitch of the view, which counts only where [`Self::may_pitch`] is true.
    pitch: f64,
    may_pitch: bool,
    /// The head in the stage, as last located; turns are about it.
    stage_from_head: Pose,
    /// The hands' rays in the stage, as last known.
    stage_from_aim: [Option<Pose>; 2],
    held: ([f32; 3], bool),
    /// Directions of keys that went down since the last frame: one that is up again by now still moves for a frame.
    tapped: [f32; 3],
    is_walking: bool,
    /// Height of the stage's floor above that which the user stands on, meters.
    raised_m: f64,
    floors: FloorsCell,
    gestures: Gestures,
    grab: Grab,
    feet: Feet,
    vignette: Vignette,
    visits: Visits,
    /// Where the user was before the scan became a model.
    before_model: Option<Standpoint>,
    guides: Guides,
}

impl Locomotion {
    /// A viewer who begins at the start, with their head above it wherever in the stage it is. Until `floors` are there, one
    /// flies; until `starts` are, the scan is taken for what it is at first.
    #[must_use]
    pub fn new(
        options: LocomotionOptions,
        start: Start,
        starts: StartsCell,
        floors: FloorsCell,
        stations: Vec<Standpoint>,
        stage_from_head: &Pose,
    ) -> Self {
        let Standpoint { floor_in_world, yaw, .. } = start.standpoint;
        let mut user = Self {
            options,
            start,
            said: None,
            starts,
            place: StagePlace::new(floor_in_world, yaw, start.units_per_m),
            pitch: 0.0,
            may_pitch: false,
            stage_from_head: *stage_from_head,
            stage_from_aim: [None; 2],
            held: ([0.0; 3], false),
            tapped: [0.0; 3],
            is_walking: false,
            raised_m: 0.0,
            floors,
            gestures: Gestures::new(options.moving_hand.index(), options.turn),
            grab: Grab::default(),
            feet: Feet::default(),
            vignette: Vignette::new(options.vignette),
            visits: Visits::new(stations),
            before_model: None,
            guides: Guides::default(),
        };
        user.begin();
        user
    }

    /// Begins with the head here: the headset has told for the first time where it is.
    pub fn begin_with(&mut self, stage_from_head: &Pose) {
        self.stage_from_head = *stage_from_head;
        self.reset();
    }

    /// The eyes as the pitch of the view turns them about the head, in the stage.
    #[must_use]
    pub fn pitched(&self, eyes: &[StageEye; 2]) -> [StageEye; 2] {
        if !self.may_pitch || self.pitch == 0.0 {
            return *eyes;
        }
        let head = head_of(eyes);
        let orientation = (head.orientation * DQuat::from_rotation_x(self.pitch)).normalize();
        let pitched = Pose { orientation, ..head };
        eyes.map(|eye| {
            let head_from_view = head.inverse().then(&eye.stage_from_view);
            StageEye { stage_from_view: pitched.then(&head_from_view), ..eye }
        })
    }

    /// Sets whether the mouse may look up and down, which is for simulated headsets only: a head pitches itself.
    pub fn set_may_pitch(&mut self, may_pitch: bool) {
        self.may_pitch = may_pitch;
    }

    /// Meters a second, of the user's, at full deflection, until the user changes it.
    #[must_use]
    pub fn speed(&self) -> f64 {
        // One moves slowly round a small object, and round a model.
        let extent_m = self.start.extent_m * self.place.scale;
        let chosen = (0.1 * extent_m).clamp(extent_m.clamp(0.1, 1.0), 60.0);
        let chosen = if self.walked_floors().is_some() { chosen.min(WALK_M_PER_S) } else { chosen };
        self.options.speed_m_per_s.unwrap_or(chosen)
    }

    /// Where the stage stands, for the log.
    #[must_use]
    pub fn place(&self) -> Place {
        let StagePlace { floor_in_world, yaw, .. } = self.place;
        Place { floor_in_world, yaw_deg: yaw.to_degrees(), units_per_m: self.place.units_per_m() }
    }

    /// The floor on which the walk began, in the stage: upright, and turned as the world is.
    #[must_use]
    pub fn stage_from_start(&self) -> Pose {
        self.place.stage_from_level(self.start.standpoint.floor_in_world)
    }

    /// Where the stage stands.
    #[must_use]
    pub fn stage(&self) -> &StagePlace {
        &self.place
    }

    /// What the last frame shows of how the user moves.
    #[must_use]
    pub fn guides(&self) -> &Guides {
        &self.guides
    }

    /// What surfaces show of how the user is in the scan.
    #[must_use]
    pub fn stance(&self) -> Stance {
        let Self { is_walking, raised_m, .. } = *self;
        Stance {
            kind: self.start.kind,
            said: self.said,
            is_walking,
            scale: self.place.scale,
            is_scaling: self.guides.scale.is_some(),
            raised_m,
            num_places: self.visits.num(),
            turn: self.gestures.turn(),
            vignette: self.vignette.strength(),
            vignette_options: self.vignette.options(),
        }
    }

    /// Where the user would stand who points along a ray in the world: that of a hand, or of a pixel of the mirror. They keep
    /// facing where they do.
    #[must_use]
    pub fn pointed_at(&self, from_in_world: DVec3, along_in_world: DVec3) -> Option<Landing> {
        let units_per_m = self.place.units_per_m();
        let along = along_in_world.try_normalize()?;
        let floors = self.floors.get()?;
        let floor = arc::pointed_at(floors, from_in_world, along, POINTED_M * units_per_m, units_per_m)?;
        Some(Landing { floor_in_world: floor, yaw: self.facing() })
    }

    /// Goes to the floor that a ray in the world points at; a model becomes as large as life there. False if it points at no
    /// floor.
    pub fn go_where_pointed(&mut self, from_in_world: DVec3, along_in_world: DVec3) -> bool {
        let Some(Landing { floor_in_world, yaw }) = self.pointed_at(from_in_world, along_in_world) else {
            return false;
        };
        let scale = if self.place.scale < LEAST_WALKED { 1.0 } else { self.place.scale };
        self.go(&Standpoint { floor_in_world, yaw, scale });
        true
    }

    /// Applies what moves the viewer.
    pub fn apply(&mut self, action: Action) {
        match action {
            Action::Move { direction, fast } => {
                self.held = (direction, fast);
                for (tapped, along) in
                    self.tapped.iter_mut().zip(direction).filter(|(_, along)| *along != 0.0)
                {
                    *tapped = along;
                }
            }
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
                self.pitch = 0.0;
                let overview = self.start.overview;
                self.go(&overview);
            }
            Action::TopView => self.look_down(),
            Action::Orbit { delta_px } => self.orbit(delta_px),
            Action::TeleportTo { floor_in_world, yaw } => {
                self.go(&Standpoint { floor_in_world, yaw, scale: self.place.scale });
            }
            Action::ToggleWalking => {
                self.is_walking = !self.is_walking;
                self.feet.forget();
            }
            Action::TakeFor(kind) => {
                let found =
                    self.starts.get().and_then(|starts| starts.iter().find(|start| start.kind == kind));
                if let Some(start) = found {
                    (self.start, self.said) = (*start, Some(kind));
                    self.begin();
                }
            }
            Action::SetTurn(turn) => self.gestures.set_turn(turn),
            Action::SetVignette(part) => self.vignette.set_strength(part),
            Action::ShowModel => self.show_model(),
            Action::LifeSize => self.life_size(),
            Action::SavePlace => self.visits.save(self.standpoint()),
            Action::NextPlace => self.visit(1),
            Action::PreviousPlace => self.visit(-1),
            Action::Raise(meters) => self.raise(self.raised_m + f64::from(meters)),
            Action::ToggleSeated => {
                let eye_m = self.stage_from_head.position.y;
                self.raise(if self.raised_m == 0.0 { STANDING_EYE_M - eye_m } else { 0.0 });
            }
            // These are the state's, or the walk's.
            Action::Faster(_) | Action::SetSpeed(_) | Action::SetOverlay(_) | Action::NextOverlay => {}
            Action::ToggleMenu(_)
            | Action::ToggleButtons
            | Action::SetAppearance(_)
            | Action::SetPreset(_) => {}
            Action::GoToSeen { .. } | Action::LookForHeadset | Action::Open(_) => {}
            Action::Screenshot | Action::Quit => {}
        }
    }

    /// Moves by what hands and keys do for `seconds`, `faster` times as fast as [`Self::speed`]. `stage_from_head` is the
    /// head as last located: forward is the direction in which it looks. What a hand asks for once is the same [`Action`] that a
    /// key sends; sticks and hands that hold the world move on with each frame. Returns the hand whose menu button has gone
    /// down.
    pub fn advance(
        &mut self,
        seconds: f64,
        faster: f32,
        controllers: &ControllerInput,
        stage_from_head: &Pose,
    ) -> Option<usize> {
        self.stage_from_head = *stage_from_head;
        self.stage_from_aim = controllers.hands.map(|hand| hand.stage_from_aim);
        let seconds = seconds.clamp(0.0, LONGEST_FRAME_S);
        let intents = self.gestures.advance(controllers, seconds);
        let landing = self.guides.arc.and_then(|arc| arc.landing);
        self.guides = Guides::default();
        self.hold(controllers, &intents);
        self.aim(&intents, landing);
        for (hand, &steps) in intents.snaps.iter().enumerate().filter(|(_, steps)| **steps != 0) {
            self.apply(Action::Snap(steps));
            self.guides.events[hand] = Some(Event::Snap);
        }
        self.turn(-intents.turn * self.options.turn_rad_per_s * seconds);
        self.stride(seconds, faster, intents.stride);
        let moved = intents.stride.length().max(intents.turn.abs());
        self.vignette.advance(moved, seconds);
        self.guides.vignette = self.vignette.now() as f32;
        if intents.reset {
            self.apply(Action::Reset);
        }
        intents.menu
    }

    /// Moves the world with the hands that hold it.
    fn hold(&mut self, controllers: &ControllerInput, intents: &Intents) {
        let hands = [0, 1].map(|hand: usize| {
            let input = controllers.hands[hand];
            let pose = input.stage_from_grip.or(input.stage_from_aim).filter(|_| intents.grab[hand]);
            pose.map(|pose| pose.position)
        });
        let limits = model::limits(&self.start.bounds, self.place.life_units_per_m());
        if let Some(event) = self.grab.advance(&mut self.place, hands, limits) {
            self.guides.events = hands.map(|hand| hand.map(|_| event));
        }
        if self.grab.is_holding() {
            self.feet.forget();
        }
        self.guides.scale = self.grab.is_scaling().then_some(self.place.scale);
    }

    /// Throws the arc of the hand that aims, or takes the user to `landing`, where the frame before showed that it ends.
    fn aim(&mut self, intents: &Intents, landing: Option<Landing>) {
        if let Some(hand) = intents.cancelled {
            self.guides.events[hand] = Some(Event::Cancel);
        }
        let Some(aim) = intents.aim else { return };
        // A head that has turned since is no turn of the world.
        let yaw = self.facing() + aim.twist;
        if let Some(hand) = intents.go {
            if let Some(Landing { floor_in_world, .. }) = landing {
                self.apply(Action::TeleportTo { floor_in_world, yaw });
                self.guides.events[hand] = Some(Event::Arrival);
            }
            return;
        }
        if intents.began {
            self.guides.events[aim.hand] = Some(Event::Aim);
        }
        if let Some(stage_from_aim) = self.stage_from_aim[aim.hand] {
            let hand = self.place.pose_in_world(&stage_from_aim);
            let level = self.feet_in_world().z;
            let ground = self.floors.get().map_or(Ground::Level(level), Ground::Floors);
            let (speed, units_per_m) = (arc::speed_for(self.options.reach_m), self.place.units_per_m());
            let along = hand.orientation * DVec3::NEG_Z;
            self.guides.arc = Some(arc::arc(ground, hand.position, along, yaw, speed, units_per_m));
        }
    }

    /// Walks or flies by keys and the stick.
    fn stride(&mut self, seconds: f64, faster: f32, stick: DVec2) {
        let units_per_m = self.place.units_per_m();
        let step = self.speed() * f64::from(faster) * units_per_m * seconds;
        let tapped = std::mem::take(&mut self.tapped);
        let keys = [0, 1, 2].map(|axis: usize| [self.held.0[axis], tapped[axis]]);
        let [right, up, forward] =
            keys.map(|[held, tapped]| f64::from(if held == 0.0 { tapped } else { held }));
        let fast = if self.held.1 { self.options.fast } else { 1.0 };
        let across = DVec2::new(right, forward) * fast + stick;
        let rise = DVec3::Z * up * fast;
        if self.walked_floors().is_none() {
            let direction = DVec3::new(across.x, 0.0, -across.y);
            let in_world = self.world_from_head(&self.stage_from_head).orientation * direction;
            self.place.floor_in_world += (in_world + rise) * step;
            return;
        }
        let way = DVec2::from_angle(self.facing()).rotate(across) * step;
        let from = self.feet_in_world();
        self.place.floor_in_world += way.extend(0.0) + rise * step;
        if up != 0.0 {
            // Whoever leaves the floor by a key stays where they are.
            self.feet.forget();
        } else if let Some(floors) = self.floors.get() {
            if way != DVec2::ZERO {
                self.feet.walk(floors, from, from.truncate() + way, units_per_m);
            }
            self.place.floor_in_world.z += self.feet.rise(from.z, seconds, units_per_m);
        }
    }

    /// The floors that one walks on; `None` if one flies.
    fn walked_floors(&self) -> Option<&Floors> {
        let walks = self.is_walking && self.place.scale >= LEAST_WALKED;
        self.floors.get().filter(|floors| walks && !floors.is_empty())
    }

    /// Turns to the left by `angle` about the head.
    fn turn(&mut self, angle: f64) {
        self.place.turn_about(self.stage_from_head.position, angle);
    }

    fn facing(&self) -> f64 {
        self.place.facing(&self.stage_from_head)
    }

    fn standpoint(&self) -> Standpoint {
        self.place.standpoint(&self.stage_from_head, self.raised_m)
    }

    /// The floor below the head, if the user stands on it.
    fn feet_in_world(&self) -> DVec3 {
        self.standpoint().floor_in_world
    }

    /// Takes the user somewhere.
    fn go(&mut self, to: &Standpoint) {
        self.place.stand(to, &self.stage_from_head, self.raised_m);
        self.feet.forget();
    }

    /// Begins at the start, walking or flying as one begins there.
    fn begin(&mut self) {
        self.is_walking = match self.options.stride {
            Stride::Auto => self.start.walks,
            Stride::Walk => true,
            Stride::Fly => false,
        };
        self.reset();
    }

    fn reset(&mut self) {
        self.pitch = 0.0;
        self.before_model = None;
        let standpoint = self.start.standpoint;
        self.go(&standpoint);
        if self.start.kind == ScanKind::Landscape {
            self.show_model();
        }
    }

    fn visit(&mut self, steps: i64) {
        if let Some(place) = self.visits.step(steps) {
            self.go(&place);
        }
    }

    fn show_model(&mut self) {
        if self.before_model.is_none() {
            self.before_model = Some(self.standpoint());
        }
        model::show(&mut self.place, &self.start.bounds, &self.stage_from_head);
        // A head that cannot bow is helped to look at it.
        self.pitch = model::pitch(&self.place, &self.start.bounds, &self.stage_from_head);
        self.feet.forget();
    }

    /// Shows the scan as large as life, from the place that a hand or the head points at; if it points at none, from where
    /// the user was, or from the ground in its middle if they have never stood in it.
    fn life_size(&mut self) {
        let pointer = match self.stage_from_aim[1].or(self.stage_from_aim[0]) {
            Some(stage_from_aim) => self.place.pose_in_world(&stage_from_aim),
            None => self.world_from_head(&self.stage_from_head),
        };
        let pointed = self.pointed_at(pointer.position, pointer.orientation * DVec3::NEG_Z);
        let before = self.before_model.take();
        // A landscape begins as a model, before anybody has stood in it.
        let begun = self.start.standpoint.floor_in_world;
        let far = BEGUN_M * self.start.units_per_m;
        let has_left = |before: &Standpoint| before.floor_in_world.distance(begun) > far;
        let has_stood = self.start.kind != ScanKind::Landscape || before.as_ref().is_some_and(has_left);
        let top = self.start.bounds.center().with_z(self.start.bounds.max.z);
        let below = || self.pointed_at(top, DVec3::NEG_Z).filter(|_| !has_stood);
        let stands = |Landing { floor_in_world, yaw }| Standpoint { floor_in_world, yaw, scale: 1.0 };
        let pointed = pointed.or_else(below).map(stands);
        match pointed.or(before.map(|before| Standpoint { scale: 1.0, ..before })) {
            Some(place) => self.go(&place),
            None => self.place.scale_about(self.stage_from_head.position.with_y(-self.raised_m), 1.0),
        }
    }

    fn raise(&mut self, raised_m: f64) {
        let raised_m = if raised_m.is_finite() { raised_m.clamp(-MOST_RAISED_M, MOST_RAISED_M) } else { 0.0 };
        self.place.floor_in_world.z += (raised_m - self.raised_m) * self.place.units_per_m();
        self.raised_m = raised_m;
    }

    /// The head in the world. The pitch turns it about itself, not about the stage's origin.
    #[must_use]
    pub fn world_from_head(&self, stage_from_head: &Pose) -> Pose {
        let Pose { position, orientation } = self.place.pose_in_world(stage_from_head);
        let pitch = if self.may_pitch { self.pitch } else { 0.0 };
        Pose { position, orientation: (orientation * DQuat::from_rotation_x(pitch)).normalize() }
    }
}

#[cfg(test)]
#[path = "locomotion_tests.rs"]
mod tests;
