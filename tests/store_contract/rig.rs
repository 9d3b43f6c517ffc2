//! A store to try, its clock, and what to put into it.

pub use std::sync::Arc;
pub use std::time::Duration;

pub use bytes::Bytes;
pub use mouldloft::jobs::clock::{Clock, ManualClock};
pub use mouldloft::jobs::model::*;
use mouldloft::jobs::store::memory::MemoryStore;
use mouldloft::jobs::store::sqlite::SqliteStore;
pub use mouldloft::jobs::store::*;

pub const LEASE: Duration = Duration::from_secs(30);
pub const HOUR: Duration = Duration::from_secs(3600);
pub const DAY: Duration = Duration::from_secs(24 * 3600);
pub const MAX_LOST: u32 = 3;
pub const ROOMY: Limits = Limits {
    jobs: 1000,
    bytes: 1_000_000,
    idempotency_age: DAY,
};

pub struct Rig {
    pub store: Arc<dyn Store>,
    pub clock: Arc<ManualClock>,
    pub tenant: Tenant,
    _folder: Option<tempfile::TempDir>,
}

impl Rig {
    pub fn clock() -> Arc<ManualClock> {
        let start = Timestamp::from_millis(1_790_000_000_000);
        Arc::new(ManualClock::at(start))
    }

    pub fn memory() -> Rig {
        let clock = Rig::clock();
        Rig {
            store: Arc::new(MemoryStore::new(clock.clone())),
            clock,
            tenant: Tenant::local(),
            _folder: None,
        }
    }

    pub fn sqlite() -> Rig {
        let clock = Rig::clock();
        let folder = tempfile::tempdir().unwrap();
        Rig {
            store: Arc::new(SqliteStore::open(folder.path(), clock.clone()).unwrap()),
            clock,
            tenant: Tenant::local(),
            _folder: Some(folder),
        }
    }

    pub async fn submit(&self, new: NewJob) -> Admission {
        self.store.accept(&self.tenant, new, ROOMY).await.unwrap()
    }

    pub async fn accepted(&self, input: &str) -> Job {
        match self.submit(new_job(input)).await {
            Admission::New(job) => job,
            other => panic!("not a new job: {other:?}"),
        }
    }

    pub async fn claim_one(&self, owner: &Owner) -> Option<Claim> {
        let mut claims = self.store.claim(owner, 1, LEASE).await.unwrap();
        assert!(claims.len() <= 1);
        claims.pop()
    }

    pub async fn get(&self, id: JobId) -> Option<Job> {
        self.store.get(&self.tenant, id).await.unwrap()
    }

    pub async fn blob(&self, id: JobId, kind: BlobKind) -> Option<Bytes> {
        let looked = self.store.blob(&self.tenant, id, kind).await.unwrap();
        looked.unwrap().blob
    }

    pub async fn run_to(&self, outcome: Outcome) -> Job {
        self.accepted("{}").await;
        let claim = self.claim_one(&owner("a")).await.unwrap();
        let fence = fence(&claim, "a");
        let ended = self.store.complete(fence, end(outcome)).await.unwrap();
        ended.unwrap()
    }

    pub async fn page(&self, query: ListQuery) -> Page {
        self.store.list(&self.tenant, query).await.unwrap().unwrap()
    }
}

pub fn new_job(input: &str) -> NewJob {
    NewJob {
        method: "hull_plates".to_owned(),
        label: Some("trawler".to_owned()),
        input: Bytes::copy_from_slice(input.as_bytes()),
        input_sha256: format!("sha of {input}"),
        budget: Duration::from_millis(60_500),
        idempotency: None,
        engine_version: "0.1.0".to_owned(),
        warnings: vec!["one \"quoted\" line".to_owned()],
    }
}

pub fn keyed(input: &str, key: &str, body: &str) -> NewJob {
    NewJob {
        idempotency: Some(IdempotencyKey {
            key: key.to_owned(),
            body_sha256: body.to_owned(),
        }),
        ..new_job(input)
    }
}

pub fn owner(name: &str) -> Owner {
    Owner(name.to_owned())
}

pub fn fence(claim: &Claim, by: &str) -> Fence {
    Fence {
        id: claim.job.id,
        attempt: claim.job.attempt,
        owner: owner(by),
    }
}

pub fn successful(result: &str) -> Outcome {
    Outcome::Successful {
        result: Bytes::copy_from_slice(result.as_bytes()),
        diagnostics: Bytes::from_static(b"{\"steps\":4}"),
        verdict: Verdict::OutsideLimits,
        warnings: vec!["late".to_owned()],
        message: "plate 3 twists".to_owned(),
    }
}

pub fn failed(diagnostics: Option<&'static [u8]>) -> Outcome {
    Outcome::Failed {
        failure: Failure {
            code: "singular".to_owned(),
            detail: "no pivot in row 7".to_owned(),
            reference: Some(JobId::random().as_uuid()),
            errors_json: Some("[]".to_owned()),
        },
        diagnostics: diagnostics.map(Bytes::from_static),
    }
}

pub fn end(outcome: Outcome) -> End {
    End {
        outcome,
        solve_ms: 12.5,
        phase: "fitting".to_owned(),
        progress: 42.0,
    }
}

pub fn beat_of(claim: &Claim, by: &str, progress: f64, ticks: u64) -> Beat {
    Beat {
        fence: fence(claim, by),
        phase: "rulings".to_owned(),
        progress,
        ticks,
    }
}
