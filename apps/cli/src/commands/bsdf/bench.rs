//! `kajo bsdf bench`: what calls of models cost.

use super::{Chosen, entry, prepare};
use crate::arguments::Common;
use crate::arguments::bsdf::{Bench, Form};
use crate::failure::{Failure, Outcome};
use crate::{output, progress};
use kajo_bsdf::models::{Operations, all};
use kajo_bsdf_lab::bench::{CLAIMED_RATIO, Costs, Inputs, ModelCost, Nanoseconds, Subject, Survey, bench, surveyed, weight};
use kajo_lab::model_cost::{ModelCost as GpuCost, time_model};
use kajo_params::ParamValues;
use kajo_render_graph::Device;
use serde_json::{Value, json};

/// What all ratios are to. Lambert's shading function computes a cosine, as the survey's does.
const BASE: &str = "lambert-bsf";

/// Times the models and prints the table, the thesis's ratios beside it.
pub fn run(common: &Common, arguments: &Bench) -> Outcome {
    let chosen = choose(arguments)?;
    // Ratios need their base, whether it was asked for or not.
    let base = prepare(entry(BASE)?, &[], Form::Corrected)?;
    let position = chosen.iter().position(|c| c.entry.id == BASE && is_default(c));
    let models = chosen.iter().chain(position.is_none().then_some(&base));
    let subjects: Vec<_> = models.map(|c| Subject { id: c.entry.id, model: &*c.model, is_default: is_default(c) }).collect();
    let bar = progress::bar(common.quiet, "timing");
    let costs = bench(&subjects, arguments.calls, |share| {
        bar.set_position((share * 1000.0) as u64);
        !progress::interrupted()
    });
    bar.finish_and_clear();
    let mut costs = costs.ok_or_else(|| Failure::run("stopped: times of some rounds only would mislead".to_owned()))?;
    let base = costs.models[position.unwrap_or(chosen.len())].raw;
    costs.models.truncate(chosen.len());
    let gpu = arguments.gpu.then(|| on_gpu(&chosen));
    if common.json {
        let mut json = as_json(&chosen, &costs, base);
        if let Some(gpu) = &gpu {
            json["gpu"] = gpu_json(gpu);
        }
        output::json(&json)
    } else {
        output::text(&(as_text(&costs, base) + &gpu.as_ref().map_or_else(String::new, gpu_text)))
    }
}

/// The adapter with the cost of each model, or why there is none.
type OnGpu = Result<(String, Vec<(&'static str, GpuCost)>), String>;

fn on_gpu(chosen: &[Chosen]) -> OnGpu {
    let device = Device::new().map_err(|error| error.to_string())?;
    let inputs = Inputs::new();
    let (wi, wo) = inputs.block(0);
    let pairs: Vec<_> = wi.iter().copied().zip(wo.iter().copied()).collect();
    let mut costs = Vec::new();
    for chosen in chosen.iter().filter(|chosen| chosen.entry.wesl.is_some()) {
        if progress::interrupted() {
            return Err("stopped".to_owned());
        }
        costs.push((chosen.entry.id, time_model(&device, chosen.entry, &*chosen.model, &pairs).map_err(|error| error.to_string())?));
    }
    Ok((device.info().name.clone(), costs))
}

fn gpu_json(gpu: &OnGpu) -> Value {
    match gpu {
        Err(reason) => json!({ "skipped": reason }),
        Ok((adapter, costs)) => {
            let models: Vec<_> = costs
                .iter()
                .map(|(id, cost)| {
                    json!({ "model": id, "ns": cost.ns, "evaluations": cost.evaluations, "on_device_timer": cost.on_device,
                        "checksum": cost.checksum, "checksum_cpu": cost.expected })
                })
                .collect();
            json!({ "adapter": adapter, "models": models })
        }
    }
}

fn gpu_text(gpu: &OnGpu) -> String {
    match gpu {
        Err(reason) => format!("\ngpu: skipped: {reason}\n"),
        Ok((adapter, costs)) => {
            let base = costs.iter().find(|(id, _)| *id == BASE).map(|(_, cost)| cost.ns);
            let rows: Vec<_> = costs
                .iter()
                .map(|(id, cost)| {
                    let ratio = base.map_or_else(String::new, |base| format!("{:.2}", cost.ns / base));
                    vec![
                        (*id).to_owned(),
                        format!("{:.4}", cost.ns),
                        ratio,
                        format!("{:.6}", cost.checksum),
                        format!("{:.6}", cost.expected),
                    ]
                })
                .collect();
            format!("\non {adapter}\n{}", output::table(&["model", "ns", "/ Lambert", "checksum", "of the CPU"], &rows))
        }
    }
}

fn is_default(chosen: &Chosen) -> bool {
    chosen.values == ParamValues::defaults(chosen.entry.params)
}

fn choose(arguments: &Bench) -> Outcome<Vec<Chosen>> {
    match arguments.model.as_slice() {
        [] => all().filter(|entry| entry.wesl.is_some()).map(|entry| prepare(entry, &[], Form::Corrected)).collect(),
        [id] => Ok(vec![prepare(entry(id)?, &arguments.params, Form::Corrected)?]),
        _ if !arguments.params.is_empty() => {
            Err(Failure::usage(format!("--param is given with {} models; give one --model, or no --param", arguments.model.len())))
        }
        ids => ids.iter().map(|id| prepare(entry(id)?, &[], Form::Corrected)).collect(),
    }
}

fn as_json(chosen: &[Chosen], costs: &Costs, base: Nanoseconds) -> Value {
    let base_net = costs.net(base);
    let models: Vec<_> = chosen
        .iter()
        .zip(&costs.models)
        .map(|(chosen, cost)| {
            let (raw, net) = (cost.raw, costs.net(cost.raw));
            json!({
                "model": cost.id, "params": chosen.values.to_json(), "calls": costs.calls,
                "ns": raw.single, "ns_net": net.single, "ns_many": raw.many, "ns_many_net": net.many,
                "ratio_to_lambert": raw.single / base.single, "ratio_to_lambert_net": net.single / base_net.single,
                "ratio_to_lambert_many": raw.many / base.many,
                "thesis": surveyed(&cost.id).map(|survey| match survey {
                    Survey::Measured(ns) => json!({ "ns": ns, "ratio_to_lambert": survey.ratio() }),
                    Survey::NotMeasured => json!("not measured"),
                }),
                "checksum": cost.checksums[0], "checksum_many": cost.checksums[1],
                "operations": cost.operations.as_ref().map(operations),
                "by_hand": cost.by_hand.map(|(ns, checksum)| json!({ "ns": ns, "checksum": checksum, "ratio": raw.many / ns })),
            })
        })
        .collect();
    let fresnel = &costs.fresnel;
    let ratios = fresnel.ratios();
    json!({
        "calls": costs.calls, "rounds": costs.rounds, "instructions": costs.instructions.name(), "lanes": costs.instructions.lanes(),
        "empty": { "ns": costs.empty.single, "ns_many": costs.empty.many }, "base": BASE, "models": models,
        "fresnel": {
            "claimed_ratio": CLAIMED_RATIO, "ratio": ratios.single, "ratio_many": ratios.many,
            "exact_ns": fresnel.exact.single, "schlick_ns": fresnel.schlick.single,
            "exact_ns_many": fresnel.exact.many, "schlick_ns_many": fresnel.schlick.many,
            "operations": { "exact": operations(&fresnel.operations[0]), "schlick": operations(&fresnel.operations[1]) },
        },
    })
}

fn operations(o: &Operations) -> Value {
    json!({ "add": o.add, "mul": o.mul, "div": o.div, "sqrt": o.sqrt, "exp": o.exp, "pow": o.pow, "trig": o.trig, "compare": o.compare, "weight": weight(o) })
}

fn as_text(costs: &Costs, base: Nanoseconds) -> String {
    let head = [
        "model",
        "ns",
        "net",
        "/ Lambert",
        "net",
        "thesis",
        "ns, many",
        "/ Lambert",
        "by hand",
        "operations",
        "weight",
        "checksum",
        "of many",
    ];
    let base_net = costs.net(base);
    let row = |cost: &ModelCost| {
        let (raw, net) = (cost.raw, costs.net(cost.raw));
        let thesis =
            surveyed(&cost.id).map_or_else(String::new, |s| s.ratio().map_or("not measured".into(), |ratio| format!("{ratio:.2}")));
        vec![
            cost.id.clone(),
            format!("{:.2}", raw.single),
            format!("{:.2}", net.single),
            format!("{:.2}", raw.single / base.single),
            format!("{:.2}", net.single / base_net.single),
            thesis,
            format!("{:.3}", raw.many),
            format!("{:.2}", raw.many / base.many),
            cost.by_hand.map_or_else(String::new, |(ns, _)| format!("{ns:.3} ({:.2})", raw.many / ns)),
            cost.operations.as_ref().map_or_else(String::new, in_short),
            cost.operations.as_ref().map_or_else(String::new, |o| weight(o).to_string()),
            format!("{:.6}", cost.checksums[0]),
            format!("{:.6}", cost.checksums[1]),
        ]
    };
    let rows: Vec<_> = costs.models.iter().map(row).collect();
    let fresnel = &costs.fresnel;
    let ratios = fresnel.ratios();
    format!(
        "{}\n{} calls a model and kind, in {} rounds; many: {} pairs at once by {}\nempty loop: {:.2} ns a call, {:.3} ns a pair\n\
         Fresnel's equations (3.9) over Schlick's (3.14): {:.1} one by one ({:.2} ns, {:.2} ns), {:.1} many at once ({:.3} ns, {:.3} ns), {:.1} in operations; claimed {CLAIMED_RATIO}\n",
        output::table(&head, &rows),
        costs.calls,
        costs.rounds,
        kajo_bsdf_lab::bench::BLOCK,
        costs.instructions.name(),
        costs.empty.single,
        costs.empty.many,
        ratios.single,
        fresnel.exact.single,
        fresnel.schlick.single,
        ratios.many,
        fresnel.exact.many,
        fresnel.schlick.many,
        f64::from(weight(&fresnel.operations[0])) / f64::from(weight(&fresnel.operations[1])),
    )
}

/// `12+ 20× 2÷ 3√ 1exp`
fn in_short(o: &Operations) -> String {
    let parts =
        [(o.add, "+"), (o.mul, "×"), (o.div, "÷"), (o.sqrt, "√"), (o.exp, " exp"), (o.pow, " pow"), (o.trig, " trig"), (o.compare, " cmp")];
    parts.into_iter().filter(|(count, _)| *count > 0).map(|(count, name)| format!("{count}{name}")).collect::<Vec<_>>().join(" ")
}
