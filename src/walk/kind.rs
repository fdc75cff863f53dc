//! What a scan is of, which decides where one begins to see it, and how large.

base::choice! {
    /// What a scan is of.
    #[derive(Hash)]
    pub enum ScanKind {
        /// A room, a building from inside or a tunnel, in which one stands.
        Interior = "interior",
        /// A building, a yard or a street, where one stands on the ground.
        Outdoors = "outdoors",
        /// Land so wide that nobody sees it from the ground, so that it begins as a model.
        Landscape = "landscape",
        /// A thing to be seen from outside.
        Object = "object",
    }
}
