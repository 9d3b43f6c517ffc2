//! The bill of quantities.

use super::{MemberLine, NetDrawing};
use crate::formats::csv::{END_OF_RECORD, field, harmless, number_field};

/// One record an arc below one header record that carries the units.
pub(super) fn write(drawing: &NetDrawing) -> String {
    let lengths = |name: &str| field(&format!("{name} ({})", drawing.units));
    let columns = [
        "line".to_owned(),
        "from_row".to_owned(),
        "from_column".to_owned(),
        "to_row".to_owned(),
        "to_column".to_owned(),
        lengths("radius"),
        lengths("length"),
        "angle (deg)".to_owned(),
        "node_torsion (deg)".to_owned(),
    ];
    let mut table = columns.join(",") + END_OF_RECORD;
    for member in &drawing.members {
        table.push_str(&record(member));
    }
    table
}

fn record(member: &MemberLine) -> String {
    let [from, to] = member.nodes;
    let mut fields = vec![field(&harmless(&member.line))];
    fields.extend(from.iter().chain(&to).map(usize::to_string));
    let numbers = [
        member.radius,
        member.length,
        member.angle_deg,
        member.torsion_deg,
    ];
    fields.extend(numbers.iter().map(|n| number_field(*n)));
    fields.join(",") + END_OF_RECORD
}
