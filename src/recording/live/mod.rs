//! A recording that a viewer sees while it is made: sent again whenever it has grown, of
//! which only what is new goes over the wire.

mod address;
mod connection;
mod sent;

pub(crate) use connection::Live;
