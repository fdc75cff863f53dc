//! Places to go back to: the stations that a scan was made from, where its files tell them, and those that the user saved.

use super::place::Standpoint;

/// Most places that are kept; the oldest of the user's makes room.
const MOST: usize = 100;

/// Places in the order in which they are visited: stations, then the user's.
#[derive(Clone, Debug, Default)]
pub struct Visits {
    places: Vec<Standpoint>,
    num_stations: usize,
    /// Number of the place that was visited last.
    at: Option<usize>,
}

impl Visits {
    /// The stations that a scan was made from, and no place of the user's.
    #[must_use]
    pub fn new(stations: Vec<Standpoint>) -> Self {
        Self { num_stations: stations.len(), places: stations, at: None }
    }

    /// Number of places.
    #[must_use]
    pub fn num(&self) -> usize {
        self.places.len()
    }

    /// Keeps a place of the user's.
    pub fn save(&mut self, place: Standpoint) {
        if self.places.len() - self.num_stations >= MOST {
            self.places.remove(self.num_stations);
        }
        self.places.push(place);
        self.at = Some(self.places.len() - 1);
    }

    /// The next place, or the one before with `steps` of −1; the first follows the last. `None` if there are none.
    pub fn step(&mut self, steps: i64) -> Option<Standpoint> {
        let num = i64::try_from(self.places.len()).ok().filter(|&num| num > 0)?;
        let at = match self.at {
            Some(at) => (at as i64 + steps).rem_euclid(num),
            None if steps > 0 => 0,
            None => num - 1,
        };
        self.at = Some(at as usize);
        self.places.get(at as usize).copied()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn place(x: f64) -> Standpoint {
        Standpoint { floor_in_world: DVec3::X * x, yaw: 0.0, scale: 1.0 }
    }

    fn x(place: Option<Standpoint>) -> Option<f64> {
        place.map(|place| place.floor_in_world.x)
    }

    #[test]
    fn places_go_round_in_both_directions() {
        assert_eq!(Visits::default().step(1), None);
        let mut visits = Visits::new(vec![place(1.0), place(2.0)]);
        assert_eq!(
            [1, 1, 1, -1].map(|step| x(visits.step(step))),
            [Some(1.0), Some(2.0), Some(1.0), Some(2.0)]
        );
        visits.save(place(3.0));
        assert_eq!([-1, 1, 1].map(|step| x(visits.step(step))), [Some(2.0), Some(3.0), Some(1.0)]);
        assert_eq!(x(Visits::new(vec![place(1.0), place(2.0)]).step(-1)), Some(2.0));
    }

    #[test]
    fn the_oldest_of_the_users_places_makes_room() {
        let mut visits = Visits::new(vec![place(-1.0)]);
        (0..=MOST).for_each(|number| visits.save(place(number as f64)));
        assert_eq!([1, 1].map(|step| x(visits.step(step))), [Some(-1.0), Some(1.0)]);
    }
}
