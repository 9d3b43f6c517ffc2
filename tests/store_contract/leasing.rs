//! A worker's side: taking up, beating, ending, losing.

use super::rig::*;

pub async fn claims_go_by_the_order_of_acceptance(rig: Rig) {
    let mut ids = Vec::new();
    for n in 0..5 {
        ids.push(rig.accepted(&n.to_string()).await.id);
    }
    assert_eq!(rig.get(ids[4]).await.unwrap().queue_position, Some(5));
    let two = rig.store.claim(&owner("a"), 2, LEASE).await.unwrap();
    let rest = rig.store.claim(&owner("b"), 9, LEASE).await.unwrap();
    let order: Vec<JobId> = two.iter().chain(&rest).map(|c| c.job.id).collect();
    assert_eq!(order, ids);
    assert_eq!(rest.len(), 3);
    let claim = &two[1];
    assert_eq!(claim.job.status, Status::Running);
    assert_eq!(claim.job.attempt, 1);
    assert_eq!(claim.job.started, Some(rig.clock.now()));
    assert_eq!(claim.job.queue_position, None);
    assert_eq!(claim.budget, Duration::from_millis(60_500));
    assert_eq!(claim.input.as_ref().unwrap(), "1");
    assert_eq!(rig.claim_one(&owner("a")).await, None);
}

pub async fn a_success_keeps_everything(rig: Rig) {
    let job = rig.run_to(successful("{\"surfaces\":[]}\n")).await;
    assert_eq!(rig.get(job.id).await.unwrap(), job);
    assert_eq!(job.status, Status::Successful);
    assert_eq!(job.verdict, Some(Verdict::OutsideLimits));
    assert_eq!((job.phase.as_str(), job.progress), ("done", 100.0));
    assert_eq!(job.message, "plate 3 twists");
    assert_eq!(job.warnings, ["one \"quoted\" line", "late"]);
    assert_eq!(job.solve_ms, Some(12.5));
    assert_eq!(job.result_bytes, Some(16));
    assert_eq!(job.finished, Some(rig.clock.now()));
    let result = rig.blob(job.id, BlobKind::Result).await.unwrap();
    assert_eq!(result, "{\"surfaces\":[]}\n");
    let diagnostics = rig.blob(job.id, BlobKind::Diagnostics).await.unwrap();
    assert_eq!(diagnostics, "{\"steps\":4}");
    assert_eq!(rig.store.state().backlog, Backlog::default());
}

pub async fn a_failure_keeps_its_reason_and_diagnostics(rig: Rig) {
    let outcome = failed(Some(b"{}"));
    let job = rig.run_to(outcome.clone()).await;
    assert_eq!(rig.get(job.id).await.unwrap(), job);
    assert_eq!(job.status, Status::Failed);
    assert_eq!((job.phase.as_str(), job.progress), ("fitting", 42.0));
    let Outcome::Failed { failure, .. } = outcome else {
        unreachable!()
    };
    assert_eq!(job.message, failure.detail);
    assert_eq!(job.failure, Some(failure));
    let diagnostics = rig.blob(job.id, BlobKind::Diagnostics).await;
    assert_eq!(diagnostics.unwrap(), "{}");
    assert_eq!(rig.blob(job.id, BlobKind::Result).await, None);
}

pub async fn an_end_is_final(rig: Rig) {
    for outcome in [successful("{}"), failed(None), Outcome::Dismissed] {
        let ended = rig.run_to(outcome).await;
        let stale = Fence {
            id: ended.id,
            attempt: 1,
            owner: owner("a"),
        };
        let again = rig.store.complete(stale.clone(), end(successful("x")));
        assert_eq!(again.await.unwrap(), None);
        let cancelled = rig.store.cancel(&rig.tenant, ended.id).await.unwrap();
        assert!(!cancelled.unwrap().changed);
        assert_eq!(rig.store.release(vec![stale]).await.unwrap(), []);
        rig.clock.advance(LEASE * 2);
        assert_eq!(rig.store.reap(MAX_LOST).await.unwrap(), []);
        assert_eq!(rig.claim_one(&owner("a")).await, None);
        assert_eq!(rig.get(ended.id).await.unwrap(), ended);
    }
}

pub async fn a_stale_worker_changes_nothing(rig: Rig) {
    rig.accepted("{}").await;
    let first = rig.claim_one(&owner("a")).await.unwrap();
    rig.clock.advance(LEASE);
    assert_eq!(rig.store.reap(MAX_LOST).await.unwrap().len(), 1);
    let second = rig.claim_one(&owner("b")).await.unwrap();
    assert_eq!(second.job.attempt, 2);
    let before = rig.get(second.job.id).await;

    // By an old attempt, and by the present attempt of somebody else.
    let impostor = Fence {
        attempt: 2,
        ..fence(&first, "a")
    };
    for stale in [fence(&first, "a"), impostor] {
        let beat = Beat {
            fence: stale.clone(),
            ..beat_of(&first, "a", 99.0, 50)
        };
        let pulses = rig.store.beat(vec![beat], LEASE).await.unwrap();
        assert_eq!(pulses, [Pulse::Lost]);
        let ended = rig.store.complete(stale.clone(), end(successful("stale")));
        assert_eq!(ended.await.unwrap(), None);
        assert_eq!(rig.store.release(vec![stale]).await.unwrap(), []);
    }
    assert_eq!(rig.get(second.job.id).await, before);
    assert_eq!(rig.blob(second.job.id, BlobKind::Result).await, None);

    let good = rig
        .store
        .complete(fence(&second, "b"), end(successful("good")));
    assert!(good.await.unwrap().is_some());
    let result = rig.blob(second.job.id, BlobKind::Result).await;
    assert_eq!(result.unwrap(), "good");
}

pub async fn a_beat_keeps_the_lease_and_carries_progress(rig: Rig) {
    rig.accepted("{}").await;
    let claim = rig.claim_one(&owner("a")).await.unwrap();
    rig.clock.advance(LEASE - Duration::from_millis(1));
    let beat = beat_of(&claim, "a", 40.0, 3);
    let pulses = rig.store.beat(vec![beat], LEASE).await.unwrap();
    assert_eq!(pulses, [Pulse::Held]);
    let seen = rig.get(claim.job.id).await.unwrap();
    assert_eq!((seen.phase.as_str(), seen.progress), ("rulings", 40.0));
    assert_eq!(seen.revision, claim.job.revision + 3);
    assert_eq!(seen.updated, rig.clock.now());

    rig.clock.advance(LEASE - Duration::from_millis(1));
    assert_eq!(rig.store.reap(MAX_LOST).await.unwrap(), []);
    let lower = beat_of(&claim, "a", 30.0, 3);
    rig.store.beat(vec![lower], LEASE).await.unwrap();
    let kept = rig.get(claim.job.id).await.unwrap();
    assert_eq!(kept.progress, 40.0);
    assert_eq!(kept.updated, seen.updated, "nothing visible changed");
}

pub async fn a_lost_lease_is_another_attempt_and_the_third_fails(rig: Rig) {
    let job = rig.accepted("{}").await;
    rig.accepted("behind").await;
    for attempt in 1..=MAX_LOST {
        let claim = rig.claim_one(&owner("a")).await.unwrap();
        assert_eq!((claim.job.id, claim.job.attempt), (job.id, attempt));
        rig.clock.advance(LEASE);
        let changed = rig.store.reap(MAX_LOST).await.unwrap();
        assert_eq!(changed, [rig.get(job.id).await.unwrap()]);
        let expected = match attempt {
            MAX_LOST => Status::Failed,
            _ => Status::Accepted,
        };
        assert_eq!(changed[0].status, expected);
    }
    let failure = rig.get(job.id).await.unwrap().failure.unwrap();
    assert_eq!(failure.code, "worker-crashed");
    assert!(failure.reference.is_some() && failure.detail.contains('3'));
}

pub async fn voiding_takes_every_lease(rig: Rig) {
    let job = rig.accepted("{}").await;
    rig.claim_one(&owner("a")).await.unwrap();
    let changed = rig.store.void_leases(MAX_LOST).await.unwrap();
    assert_eq!(changed.len(), 1);
    assert_eq!(changed[0].status, Status::Accepted);
    assert_eq!(changed[0].queue_position, Some(1));
    assert_eq!(rig.store.state().backlog.queued, 1);
    let again = rig.claim_one(&owner("b")).await.unwrap();
    assert_eq!((again.job.id, again.job.attempt), (job.id, 2));
}

pub async fn giving_back_costs_no_attempt(rig: Rig) {
    let job = rig.accepted("{}").await;
    for _ in 0..=MAX_LOST {
        let claim = rig.claim_one(&owner("a")).await.unwrap();
        let released = rig.store.release(vec![fence(&claim, "a")]).await.unwrap();
        assert_eq!(released[0].id, job.id);
        assert_eq!(released[0].status, Status::Accepted);
    }
    rig.claim_one(&owner("a")).await.unwrap();
    rig.clock.advance(LEASE);
    let lost = rig.store.reap(MAX_LOST).await.unwrap();
    assert_eq!(lost[0].status, Status::Accepted);
}

pub async fn a_revision_rises_with_every_visible_change(rig: Rig) {
    let job = rig.accepted("{}").await;
    let mut seen = vec![job.revision];
    for attempt in ["a", "b"] {
        let claim = rig.claim_one(&owner(attempt)).await.unwrap();
        seen.push(claim.job.revision);
        for ticks in 1..4 {
            let beat = beat_of(&claim, attempt, 10.0, ticks);
            rig.store.beat(vec![beat], LEASE).await.unwrap();
            seen.push(rig.get(job.id).await.unwrap().revision);
        }
        rig.store.void_leases(MAX_LOST).await.unwrap();
        seen.push(rig.get(job.id).await.unwrap().revision);
    }
    let claim = rig.claim_one(&owner("c")).await.unwrap();
    seen.push(claim.job.revision);
    let cancelled = rig.store.cancel(&rig.tenant, job.id).await.unwrap();
    seen.push(cancelled.unwrap().job.revision);
    let ended = rig
        .store
        .complete(fence(&claim, "c"), end(Outcome::Dismissed));
    seen.push(ended.await.unwrap().unwrap().revision);
    assert!(seen.is_sorted_by(|a, b| a < b), "{seen:?}");
}
