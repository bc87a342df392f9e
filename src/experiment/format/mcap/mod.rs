//! MCAP: logs of ROS 2. Each number of the messages of each topic is a column.
//!
//! A column is called by topic and field: `/valve.data[0]`, `/joint_states.position[boom]`.
//! An element of an array is called by its name where the message names its elements, in a
//! field `name` or `…names`, else by its number from 0. Messages are decoded by the
//! definitions that the file itself holds.
//!
//! Topics come in their own time. The rows are the messages of the topic of the output; what
//! comes from other topics is held from their latest message; of a slow output there are rows meanwhile.
//! Messages are read twice at
//! most: until each topic is known, and for their values, which are all that is kept.

mod align;
mod between;
mod clock;
mod columns;
mod contents;
mod decode;
mod fault;
mod later;
mod lengths;
mod message;
mod pauses;
mod restarts;
mod series;
mod stream;

pub(super) use columns::open;
