//! What will be run: roles, and techniques with their parameters, checked before anything is rendered.

use crate::reference::judged_roles;
use crate::{CompareOptions, LabError};
use kajo_params::ParamValues;
use kajo_techniques::{Role, Technique};

/// A technique with its parameters.
#[derive(Clone, Debug)]
pub struct Choice {
    /// The technique.
    pub technique: &'static Technique,
    /// All its parameters.
    pub params: ParamValues,
}

/// The techniques of each role, in the order of the report.
pub type Plan = Vec<(Role, Vec<Choice>)>;

/// Checks roles, techniques and parameters.
///
/// # Errors
/// Unknown names with the nearest one, values out of range, roles that no image of the path tracer judges, nothing to run.
pub fn plan(options: &CompareOptions) -> Result<Plan, LabError> {
    let choice = |text: &str| kajo_techniques::parse(text).map(|(technique, params)| Choice { technique, params });
    let chosen = options.techniques.iter().flat_map(|list| kajo_techniques::split_list(list)).map(choice).collect::<Result<Vec<_>, _>>()?;
    let roles = if options.roles.is_empty() { default_roles(&chosen) } else { named_roles(&options.roles)? };
    if let Some(stray) = chosen.iter().find(|c| !roles.contains(&c.technique.role)) {
        let reason = format!("{} fills the role {}, which --role leaves out", stray.technique.id, stray.technique.role.id());
        return Err(LabError::Nothing { reason });
    }
    let choices = |role: Role| -> Vec<Choice> {
        if chosen.is_empty() {
            let defaults = |t: &'static Technique| Choice { technique: t, params: ParamValues::defaults(t.params) };
            kajo_techniques::of_role(role).map(defaults).collect()
        } else {
            chosen.iter().filter(|c| c.technique.role == role).cloned().collect()
        }
    };
    let plan: Plan = roles.into_iter().map(|role| (role, choices(role))).filter(|(_, choices)| !choices.is_empty()).collect();
    if plan.is_empty() {
        return Err(LabError::Nothing { reason: "no technique fills the roles asked for; `kajo techniques` lists what there is".into() });
    }
    Ok(plan)
}

fn is_judged(role: Role) -> bool {
    judged_roles().any(|id| id == role.id())
}

/// The roles of the chosen techniques; without any, every role that has techniques and a judge.
fn default_roles(chosen: &[Choice]) -> Vec<Role> {
    let wanted = |role: &Role| {
        is_judged(*role)
            && (chosen.is_empty() && kajo_techniques::of_role(*role).next().is_some() || chosen.iter().any(|c| c.technique.role == *role))
    };
    Role::ALL.into_iter().filter(wanted).collect()
}

fn named_roles(ids: &[String]) -> Result<Vec<Role>, LabError> {
    let mut roles = Vec::new();
    for id in ids {
        let role: Role = id.parse()?;
        if !is_judged(role) {
            let judged: Vec<_> = judged_roles().collect();
            let reason = format!(
                "the role {id} is judged by {}, not by an image of the path tracer; compare has {}",
                role.judged_by(),
                judged.join(", ")
            );
            return Err(LabError::Nothing { reason });
        }
        if !roles.contains(&role) {
            roles.push(role);
        }
    }
    Ok(roles)
}

impl Choice {
    /// Parameters that are not at their default.
    pub fn changed_params(&self) -> Vec<String> {
        self.params.iter().filter(|(spec, value)| *value != spec.default).map(|(spec, _)| spec.name.to_owned()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn options(roles: &[&str], techniques: &[&str]) -> CompareOptions {
        let own = |list: &[&str]| list.iter().map(|&s| s.to_owned()).collect();
        CompareOptions { roles: own(roles), techniques: own(techniques), ..CompareOptions::default() }
    }

    fn refused(roles: &[&str], techniques: &[&str]) -> String {
        plan(&options(roles, techniques)).unwrap_err().to_string()
    }

    #[test]
    fn nothing_named_means_every_technique_of_every_judged_role() {
        let plan = plan(&options(&[], &[])).unwrap();
        let ids: Vec<_> = plan.iter().flat_map(|(_, choices)| choices.iter().map(|c| c.technique.id)).collect();
        let expected: Vec<_> = kajo_techniques::all().filter(|t| is_judged(t.role)).map(|t| t.id).collect();
        assert_eq!(ids, expected);
        assert!(ids.contains(&"shadow/none"));
    }

    #[test]
    fn one_technique_may_come_with_several_parameters() {
        for list in [&["shadow/ray-traced:samples=2", "shadow/ray-traced"][..], &["shadow/ray-traced:samples=2,shadow/ray-traced"]] {
            let plan = plan(&options(&[], list)).unwrap();
            assert_eq!((plan.len(), plan[0].1.len()), (1, 2));
            assert_eq!(plan[0].1[0].changed_params(), ["samples"]);
            assert!(plan[0].1[1].changed_params().is_empty());
        }
    }

    #[test]
    fn mistakes_are_told_before_anything_is_rendered() {
        assert!(refused(&[], &["shadow/mop"]).contains("shadow/"));
        assert!(refused(&[], &["shadow/ray-traced:samples=-1"]).contains("samples"));
        assert!(refused(&[], &["shadow/ray-traced:smples=1"]).contains("samples"));
        assert!(refused(&["shadows"], &[]).contains("direct-visibility"));
        assert!(refused(&["tone-map"], &[]).contains("analytic curve"));
        assert!(refused(&["ambient-visibility"], &["shadow/none"]).contains("leaves out"));
    }
}
