//! The clocks by which messages are timed.

use mcap::records::MessageHeader;

use super::message::stamp;

/// The times that a message bears.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Clock {
    /// When it was recorded.
    Log,
    /// When it was published.
    Publish,
    /// What the message says itself.
    Stamp,
}

impl Clock {
    pub(super) const ALL: [Self; 3] = [Self::Log, Self::Publish, Self::Stamp];

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Log => "log_time",
            Self::Publish => "publish_time",
            Self::Stamp => "header.stamp",
        }
    }

    /// The time of a message in nanoseconds.
    pub(super) fn time(
        self,
        header: &MessageHeader,
        value: &re_ros_msg::deserialize::Value,
    ) -> Option<i64> {
        match self {
            Self::Log => i64::try_from(header.log_time).ok(),
            Self::Publish => i64::try_from(header.publish_time).ok(),
            Self::Stamp => stamp(value),
        }
    }
}
