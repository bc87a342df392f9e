//! Models as users write them: TOML, schema `tauscope/model/1`.

mod document;
mod edit;
mod error;
mod fitted;
mod parameter;
mod read;
mod revise;
mod revision;
mod schema;

pub use document::ModelFile;
pub use error::ModelError;
pub use fitted::{Fitted, FittedParameter, LogHash};
pub use revision::{Revision, RevisionErrors};
