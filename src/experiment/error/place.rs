//! The row and the column that an error is about.

use super::ReadError;

impl ReadError {
    /// The row it is about: the line of the file, or the number of the sample where there are
    /// no lines.
    pub fn row(&self) -> Option<u64> {
        match self {
            Self::UnequalRow { row, .. }
            | Self::OpenQuotation { row, .. }
            | Self::LabelOrComment { row, .. }
            | Self::DuplicateColumn { row, .. }
            | Self::NotUtf8 { row, .. }
            | Self::TimeUnit { row, .. }
            | Self::MissingColumn { row, .. }
            | Self::NoJoints { row, .. }
            | Self::NoTime { row, .. }
            | Self::NotANumber { row, .. }
            | Self::NotATime { row, .. }
            | Self::DecimalMarks { row, .. }
            | Self::Thousands { row, .. }
            | Self::NoHeader { row, .. }
            | Self::Infinite { row, .. }
            | Self::BeyondPrecision { row, .. }
            | Self::Missing { row, .. }
            | Self::TimeNotIncreasing { row, .. }
            | Self::NotUniform { row, .. }
            | Self::TimeUnitChanges { row, .. }
            | Self::FewTimes { row, .. }
            | Self::NoPeriod { row, .. }
            | Self::CoarseTimes { row, .. }
            | Self::TrialNotContiguous { row, .. }
            | Self::SingleRow { row, .. }
            | Self::NoTimeInRow { row, .. } => Some(*row).filter(|row| *row > 0),
            _ => None,
        }
    }

    /// The name of the column it is about.
    pub fn column(&self) -> Option<&str> {
        match self {
            Self::NotNumbers { column, .. }
            | Self::NoLabels { column, .. }
            | Self::UnequalColumns { column, .. }
            | Self::DuplicateColumn { column, .. }
            | Self::TimeUnit { column, .. }
            | Self::WrongTimeUnit { column, .. }
            | Self::TimeUnitChanges { column, .. }
            | Self::NoPeriod { column, .. }
            | Self::MissingColumn { column, .. }
            | Self::NotANumber { column, .. }
            | Self::NotATime { column, .. }
            | Self::DecimalMarks { column, .. }
            | Self::Thousands { column, .. }
            | Self::Infinite { column, .. }
            | Self::BeyondPrecision { column, .. }
            | Self::Missing { column, .. }
            | Self::NoTimeInRow { column, .. }
            | Self::OneColumn { column, .. }
            | Self::SeveralSeries { column, .. }
            | Self::NeverMeasured { column, .. } => Some(column),
            _ => None,
        }
    }
}
