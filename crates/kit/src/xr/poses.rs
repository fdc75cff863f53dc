//! The remote device of the test runtime: sets the head, the eyes and the hands over TCP.

use std::io::{self, Read, Write};
use std::net::TcpStream;
use std::time::Duration;

/// Bytes of a message, either way.
const PACKET_BYTES: usize = 376;

/// A connection to the device, one at a time; the device keeps the last packet for as long as it is open.
pub struct Remote(TcpStream);

impl Remote {
    pub fn connect(port: u16) -> io::Result<Self> {
        let mut stream = TcpStream::connect(("127.0.0.1", port))?;
        stream.set_read_timeout(Some(Duration::from_secs(5)))?;
        // The device tells its state twice before it listens.
        stream.read_exact(&mut [0; 2 * PACKET_BYTES])?;
        Ok(Self(stream))
    }

    /// Sends a state; programs see it from one of the next frames on.
    pub fn send(&mut self, packet: &Packet) {
        self.0.write_all(&packet.bytes()).expect("the remote device listens");
    }
}

/// A rigid pose: orientation x, y, z, w and position in meters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemotePose {
    pub orientation: [f32; 4],
    pub position: [f32; 3],
}

impl RemotePose {
    pub const fn at(position: [f32; 3]) -> Self {
        Self { orientation: [0.0, 0.0, 0.0, 1.0], position }
    }
}

/// An eye: half angles in radians and pose relative to the head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemoteEye {
    /// Left, right, up, down; left and down are negative.
    pub fov: [f32; 4],
    pub head_from_eye: RemotePose,
}

/// A hand with its controller.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RemoteHand {
    /// False if the controller is switched off.
    pub active: bool,
    /// False if the hand's joints are not seen.
    pub seen: bool,
    pub pose: RemotePose,
    /// How far each finger is bent, 0 to 1: little, ring, middle, index, thumb.
    pub curl: [f32; 5],
    /// How far the trigger is pulled, 0 to 1.
    pub trigger: f32,
    /// How far the hand is closed round the controller, 0 to 1.
    pub squeeze: f32,
    /// How hard it squeezes the controller, 0 to 1.
    pub squeeze_force: f32,
    /// Deflection of the stick: x right, y forward.
    pub stick: [f32; 2],
    pub system_pressed: bool,
    pub a_pressed: bool,
    pub b_pressed: bool,
    pub stick_pressed: bool,
}

impl Default for RemoteHand {
    fn default() -> Self {
        Self {
            active: true,
            seen: true,
            pose: RemotePose::at([0.0, 1.2, -0.3]),
            curl: [0.0; 5],
            trigger: 0.0,
            squeeze: 0.0,
            squeeze_force: 0.0,
            stick: [0.0; 2],
            system_pressed: false,
            a_pressed: false,
            b_pressed: false,
            stick_pressed: false,
        }
    }
}

/// The state of the device.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Packet {
    pub head: RemotePose,
    /// `None`: the device's own eyes.
    pub eyes: Option<[RemoteEye; 2]>,
    pub left: RemoteHand,
    pub right: RemoteHand,
}

impl Default for Packet {
    fn default() -> Self {
        Self {
            head: RemotePose::at([0.0, 1.6, 0.0]),
            eyes: None,
            left: RemoteHand::default(),
            right: RemoteHand::default(),
        }
    }
}

impl Packet {
    fn bytes(&self) -> Vec<u8> {
        let none = RemoteEye { fov: [0.0; 4], head_from_eye: RemotePose::at([0.0; 3]) };
        let mut out = b"mndrmt3\0".to_vec();
        for eye in self.eyes.unwrap_or([none; 2]) {
            floats(&mut out, &eye.fov);
            pose(&mut out, &eye.head_from_eye);
            out.extend([0; 4]);
        }
        pose(&mut out, &self.head);
        out.extend([u8::from(self.eyes.is_some()), 0, 0, 0]);
        hand(&mut out, &self.left);
        hand(&mut out, &self.right);
        assert_eq!(out.len(), PACKET_BYTES);
        out
    }
}

fn floats(out: &mut Vec<u8>, values: &[f32]) {
    out.extend(values.iter().flat_map(|value| value.to_le_bytes()));
}

fn pose(out: &mut Vec<u8>, pose: &RemotePose) {
    floats(out, &pose.orientation);
    floats(out, &pose.position);
}

fn hand(out: &mut Vec<u8>, hand: &RemoteHand) {
    pose(out, &hand.pose);
    // Linear and angular velocity.
    floats(out, &[0.0; 3 + 3]);
    floats(out, &hand.curl);
    floats(out, &[hand.trigger, hand.squeeze, hand.squeeze_force]);
    floats(out, &hand.stick);
    // Trackpad force and position.
    floats(out, &[0.0; 3]);
    let buttons =
        [hand.system_pressed, hand.a_pressed, hand.b_pressed, hand.trigger > 0.9, hand.stick_pressed];
    out.extend([hand.seen, hand.active].map(u8::from));
    // Click and touch of each button; trackpad touch; padding.
    out.extend(buttons.into_iter().flat_map(|pressed| [u8::from(pressed); 2]));
    out.extend([0; 4]);
}
