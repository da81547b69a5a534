//! Batches of rays: neighbours that run alike share a walk, the others take turns.

#[cfg(target_arch = "x86_64")]
use crate::lanes::{Avx2, Avx512};
use crate::{
    lanes::{Backend, Lanes, Portable, Task},
    packet::{self, NearestHits, PacketWorld},
    ray::{Filter, Hit, Ray},
    stream::Stream,
    tlas::Tlas,
    traverse::Nearest,
};

/// Nodes and triangles that packets may test, on average, until their rays are better off each on its own way: first for hierarchies that stay
/// near the processor, then for those in far memory, which rays by turns wait for less. Measured: a bunny (13 and 28 tests a packet, 2 and 1.6
/// times as fast as rays by turns) and a terrain of two million triangles (84 and 153, half as fast).
const MOST_WORK: [f32; 2] = [192.0, 48.0];

/// How many packets are then not tried.
const PAUSE: usize = 15;

/// Share of the last packet in the average.
const NEWEST: f32 = 0.125;

/// Fewer rays are traced one after the other: too few to take turns.
const FEW: usize = 32;

impl Tlas {
    /// [`closest_hit`](Self::closest_hit) of many rays, `accept` being told which ray it is. Sixteen neighbours that run nearly alike, as those of
    /// a row of pixels do, are traced together, the others by turns.
    ///
    /// # Panics
    /// If `rays` and `hits` are not of one length.
    pub fn closest_hits(&self, rays: &[Ray], filter: Filter, accept: impl FnMut(usize, &Hit) -> bool, hits: &mut [Option<Hit>]) {
        assert_eq!(rays.len(), hits.len(), "one hit a ray");
        self.many::<_, _, false>(rays, filter, accept, |i, nearest| hits[i] = nearest.into_option());
    }

    /// [`any_hit`](Self::any_hit) of many rays, like [`closest_hits`](Self::closest_hits).
    ///
    /// # Panics
    /// If `rays` and `hits` are not of one length.
    pub fn any_hits(&self, rays: &[Ray], filter: Filter, accept: impl FnMut(usize, &Hit) -> bool, hits: &mut [bool]) {
        assert_eq!(rays.len(), hits.len(), "one answer a ray");
        self.many::<_, _, true>(rays, filter, accept, |i, nearest| hits[i] = nearest.found);
    }

    #[inline(always)]
    fn many<F: FnMut(usize, &Hit) -> bool, R: FnMut(usize, Nearest), const ANY: bool>(
        &self,
        rays: &[Ray],
        filter: Filter,
        mut accept: F,
        mut report: R,
    ) {
        let most_work = MOST_WORK[usize::from(self.is_far())];
        let (mut alone, mut pause, mut average) = (0, 0, 0.0f32);
        for first in (0..rays.len()).step_by(packet::SIZE) {
            if pause > 0 {
                pause -= 1;
                continue;
            }
            let Some((nearest, work)) = self.packet::<_, ANY>(&rays[first..], filter, |i, hit| accept(first + i, hit)) else { continue };
            self.stream::<_, _, ANY>(&rays[alone..first], filter, |i, hit| accept(alone + i, hit), |i, nearest| report(alone + i, nearest));
            (0..packet::SIZE).for_each(|i| report(first + i, nearest.get::<ANY>(i)));
            alone = first + packet::SIZE;
            average += NEWEST * (work as f32 - average);
            if average > most_work {
                pause = PAUSE;
            }
        }
        self.stream::<_, _, ANY>(&rays[alone..], filter, |i, hit| accept(alone + i, hit), |i, nearest| report(alone + i, nearest));
    }

    /// Hits of the first rays and what it took to find them. `None` if the rays are not a full packet or not alike.
    #[inline(always)]
    fn packet<F: FnMut(usize, &Hit) -> bool, const ANY: bool>(
        &self,
        rays: &[Ray],
        filter: Filter,
        accept: F,
    ) -> Option<(NearestHits, u32)> {
        let rays = rays.first_chunk().filter(|rays| packet::may_be_alike(rays))?;
        let nearest = NearestHits::before(rays);
        let mut world = PacketWorld::<F, ANY> { tlas: self, rays, filter, accept, nearest, traced: false, work: 0 };
        self.on_backend(&mut world);
        world.traced.then_some((world.nearest, world.work))
    }

    #[inline(always)]
    fn stream<F: FnMut(usize, &Hit) -> bool, R: FnMut(usize, Nearest), const ANY: bool>(
        &self,
        rays: &[Ray],
        filter: Filter,
        mut accept: F,
        mut report: R,
    ) {
        if rays.len() < FEW {
            for (i, ray) in rays.iter().enumerate() {
                report(i, self.nearest::<_, ANY>(ray, filter, |hit| accept(i, hit)));
            }
        } else {
            self.on_backend(&mut Stream::<F, R, ANY> { tlas: self, rays, filter, accept, report, next: 0 });
        }
    }

    #[inline(always)]
    fn on_backend(&self, task: &mut impl Task) {
        match self.backend() {
            #[cfg(target_arch = "x86_64")]
            Backend::Avx512 => Avx512::call(task),
            #[cfg(target_arch = "x86_64")]
            Backend::Avx2 => Avx2::call(task),
            _ => Portable::call(task),
        }
    }
}
