//! The descriptions in an FMU.

use std::fmt::Write as _;

use crate::export::description::Export;

/// Value reference of the first parameter; the variables before are those of `fmi3.c`.
const FIRST_PARAMETER: usize = 5;

/// `sources/buildDescription.xml`.
pub(super) fn build_description(name: &str) -> String {
    format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiBuildDescription fmiVersion="3.0">
  <BuildConfiguration modelIdentifier="{name}">
    <SourceFileSet language="C99">
      <SourceFile name="fmi3.c"/>
      <SourceFile name="{name}.c"/>
    </SourceFileSet>
    <Library name="m"/>
  </BuildConfiguration>
</fmiBuildDescription>
"#
    )
}

/// `modelDescription.xml`.
pub(super) fn model_description(export: &Export, name: &str, token: &str) -> String {
    let version = env!("CARGO_PKG_VERSION");
    let description = escaped(export.commented("").trim());
    let joint = escaped(&export.joint);
    let variables: String = variables(export).iter().map(Variable::xml).collect();
    let units = units(export);
    format!(
        r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="{joint}" instantiationToken="{token}"
    description="{description}" generationTool="tauscope {version}"
    variableNamingConvention="flat">
  <CoSimulation modelIdentifier="{name}" canHandleVariableCommunicationStepSize="true"
      canGetAndSetFMUState="true" canSerializeFMUState="true"/>
{units}  <LogCategories>
    <Category name="logStatusError" description="what went wrong"/>
  </LogCategories>
  <DefaultExperiment startTime="0" stepSize="0.01"/>
  <ModelVariables>
{variables}  </ModelVariables>
  <ModelStructure>
    <Output valueReference="3"/>
    <InitialUnknown valueReference="3"/>
  </ModelStructure>
</fmiModelDescription>
"#
    )
}

struct Variable<'a> {
    name: &'a str,
    reference: usize,
    causality: &'static str,
    variability: &'static str,
    description: &'a str,
    unit: &'a str,
    start: Option<f64>,
}

impl Variable<'_> {
    fn xml(&self) -> String {
        let Self { name, reference, causality, variability, .. } = self;
        let mut more = String::new();
        if let Some(start) = self.start {
            write!(more, r#" start="{start:?}""#).unwrap_or_default();
        }
        if !self.unit.is_empty() {
            write!(more, r#" unit="{}""#, escaped(self.unit)).unwrap_or_default();
        }
        let description = escaped(self.description);
        format!(
            "    <Float64 name=\"{name}\" valueReference=\"{reference}\" \
             causality=\"{causality}\" variability=\"{variability}\"\n        \
             description=\"{description}\"{more}/>\n"
        )
    }
}

fn variables(export: &Export) -> Vec<Variable<'_>> {
    let units = &export.units;
    let (input, output) =
        (units.input.as_deref().unwrap_or_default(), units.output.as_deref().unwrap_or_default());
    let own = |reference, name, causality, variability, description| Variable {
        name,
        reference,
        causality,
        variability,
        description,
        unit: "",
        start: Some(0.0),
    };
    let mut all = vec![
        Variable { start: None, unit: "s", ..own(0, "time", "independent", "continuous", "time") },
        Variable {
            unit: input,
            ..own(1, "input", "input", "discrete", "what drives the joint; held within a step")
        },
        own(2, "others", "input", "discrete", "activity of the other joints, 0 to 1"),
        Variable {
            unit: output,
            start: None,
            ..own(3, "output", "output", "discrete", "what the joint does, as it is measured")
        },
        Variable {
            unit: output,
            ..own(4, "initial_output", "parameter", "fixed", "the output at the start")
        },
    ];
    all.extend(export.parameters.iter().enumerate().map(|(number, parameter)| Variable {
        unit: &parameter.unit,
        start: Some(parameter.value),
        ..own(FIRST_PARAMETER + number, &parameter.name, "parameter", "fixed", &parameter.meaning)
    }));
    all
}

/// Every unit that a variable has.
fn units(export: &Export) -> String {
    let mut names: Vec<&str> = variables(export).iter().map(|v| v.unit).collect();
    names.sort_unstable();
    names.dedup();
    let units = names.into_iter().filter(|name| !name.is_empty());
    let units =
        units.flat_map(|name| ["    <Unit name=\"".to_owned(), escaped(name), "\"/>\n".to_owned()]);
    format!("  <UnitDefinitions>\n{}  </UnitDefinitions>\n", units.collect::<String>())
}

fn escaped(text: &str) -> String {
    let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    text.replace('"', "&quot;").replace('\n', "&#10;")
}
