//! What stands between the contact and the hand, as the device loop reports it.

/// What stands between the contact and the hand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ForceState {
    /// Nothing does.
    #[default]
    On,
    /// Forces wait for a small one to begin with.
    Waiting,
    /// Forces rise to their full size.
    Ramping,
    /// Forces are eased to what the device bears for long.
    Easing,
    /// No force is sent: the servo is late, or the session has ended.
    Off,
}
