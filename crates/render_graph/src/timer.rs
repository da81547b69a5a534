//! How long each pass took.
//!
//! Where the device has timestamps they are written before and after each pass; elsewhere each pass is submitted alone and timed from
//! outside, which adds the cost of a submission. Passes of one name are summed.

use crate::{Device, Error};
use std::time::Instant;

/// Most passes of one execution that get a timestamp; later ones are not timed. Devices allow 4096 queries in a set.
const MAX_PASSES: u32 = 2048;

/// Milliseconds of each pass, in order of execution.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Timings {
    /// Name of the pass and what it took, ms; names are unique.
    pub passes: Vec<(String, f64)>,
    /// True when the device's own timers were read, false when passes were timed from outside.
    pub on_device: bool,
}

impl Timings {
    /// Adds a time to a pass.
    pub fn add(&mut self, name: &str, ms: f64) {
        match self.passes.iter_mut().find(|(known, _)| known == name) {
            Some((_, total)) => *total += ms,
            None => self.passes.push((name.to_owned(), ms)),
        }
    }

    /// Adds the times of another execution.
    pub fn merge(&mut self, other: &Timings) {
        self.on_device = other.on_device;
        for (name, ms) in &other.passes {
            self.add(name, *ms);
        }
    }

    /// Sum of all passes, ms.
    pub fn total_ms(&self) -> f64 {
        self.passes.iter().map(|(_, ms)| ms).sum()
    }

    /// Sum of the passes whose names start with `prefix`, ms.
    pub fn sum_of(&self, prefix: &str) -> f64 {
        self.passes.iter().filter(|(name, _)| name.starts_with(prefix)).map(|(_, ms)| ms).sum()
    }
}

/// Times the passes of one execution.
pub(crate) struct Timer {
    queries: Option<Queries>,
    names: Vec<String>,
    outside: Timings,
    started: Instant,
}

struct Queries {
    set: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    mapped: wgpu::Buffer,
}

impl Timer {
    pub(crate) fn new(device: &Device, passes: usize) -> Self {
        let count = (passes as u32).clamp(1, MAX_PASSES) * 2;
        let queries = device.info().timestamps.then(|| {
            let buffer = |usage| {
                device.wgpu.create_buffer(&wgpu::BufferDescriptor {
                    label: Some("timer"),
                    size: u64::from(count) * 8,
                    usage,
                    mapped_at_creation: false,
                })
            };
            Queries {
                set: device.wgpu.create_query_set(&wgpu::QuerySetDescriptor {
                    label: Some("timer"),
                    ty: wgpu::QueryType::Timestamp,
                    count,
                }),
                resolved: buffer(wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC),
                mapped: buffer(wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST),
            }
        });
        Self { queries, names: Vec::new(), outside: Timings::default(), started: Instant::now() }
    }

    pub(crate) fn begin(&mut self, encoder: &mut wgpu::CommandEncoder, name: &str) {
        self.names.push(name.to_owned());
        self.started = Instant::now();
        self.stamp(encoder, 0);
    }

    /// Ends the pass that began last; without device timers this submits and waits.
    pub(crate) fn end(&mut self, device: &Device, encoder: &mut wgpu::CommandEncoder) -> Result<(), Error> {
        self.stamp(encoder, 1);
        if self.queries.is_none() {
            let fresh = device.wgpu.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            device.queue.submit([std::mem::replace(encoder, fresh).finish()]);
            device.wait()?;
            let ms = self.started.elapsed().as_secs_f64() * 1e3;
            self.outside.add(self.names.last().expect("a pass began"), ms);
        }
        Ok(())
    }

    fn stamp(&self, encoder: &mut wgpu::CommandEncoder, end: u32) {
        let index = self.names.len() as u32 - 1;
        if let Some(queries) = &self.queries
            && index < MAX_PASSES
        {
            encoder.write_timestamp(&queries.set, index * 2 + end);
        }
    }

    /// To be called before the last submission.
    pub(crate) fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        let count = (self.names.len() as u32).min(MAX_PASSES) * 2;
        if let Some(queries) = &self.queries
            && count > 0
        {
            encoder.resolve_query_set(&queries.set, 0..count, &queries.resolved, 0);
            encoder.copy_buffer_to_buffer(&queries.resolved, 0, &queries.mapped, 0, u64::from(count) * 8);
        }
    }

    /// To be called after the last submission; waits for it.
    pub(crate) fn read(self, device: &Device) -> Result<Timings, Error> {
        let Some(queries) = &self.queries else { return Ok(self.outside) };
        let mut timings = Timings { passes: Vec::new(), on_device: true };
        if self.names.is_empty() {
            return Ok(timings);
        }
        let ticks: Vec<u64> = crate::readback::read_mapped(device, &queries.mapped)?;
        let ms_per_tick = f64::from(device.queue.get_timestamp_period()) * 1e-6;
        for (name, pair) in self.names.iter().zip(ticks.chunks_exact(2)) {
            timings.add(name, pair[1].saturating_sub(pair[0]) as f64 * ms_per_tick);
        }
        Ok(timings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_of_one_name_are_summed() {
        let mut timings = Timings::default();
        timings.add("a", 1.0);
        timings.add("b/x", 2.0);
        timings.add("a", 3.0);
        timings.add("b/y", 4.0);
        assert_eq!(timings.passes[0], ("a".to_owned(), 4.0));
        assert_eq!((timings.total_ms(), timings.sum_of("b/")), (10.0, 6.0));
    }
}
