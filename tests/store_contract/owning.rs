//! An owner's side: seeing, cancelling, deleting, listing; and the sweep.

use super::rig::*;

pub async fn nobody_sees_the_jobs_of_others(rig: Rig) {
    let job = rig.accepted("{}").await;
    let other = Tenant::new("other");
    let (store, id) = (&rig.store, job.id);
    assert_eq!(store.get(&other, id).await.unwrap(), None);
    assert_eq!(store.cancel(&other, id).await.unwrap(), None);
    assert!(!store.delete(&other, id).await.unwrap());
    let looked = store.blob(&other, id, BlobKind::Input).await.unwrap();
    assert_eq!(looked, None);
    let page = store.list(&other, ListQuery::default()).await.unwrap();
    assert_eq!(page.unwrap().items, []);
    assert_eq!(rig.get(id).await.unwrap().status, Status::Accepted);
}

pub async fn cancelling_a_waiting_job_dismisses_it(rig: Rig) {
    let (job, next) = (rig.accepted("1").await, rig.accepted("2").await);
    let cancelled = rig.store.cancel(&rig.tenant, job.id).await.unwrap();
    let cancelled = cancelled.unwrap();
    assert!(cancelled.changed && cancelled.job.revision > job.revision);
    assert_eq!(cancelled.job.status, Status::Dismissed);
    assert_eq!(cancelled.job.finished, Some(rig.clock.now()));
    let again = rig
        .store
        .cancel(&rig.tenant, job.id)
        .await
        .unwrap()
        .unwrap();
    assert_eq!((again.job, again.changed), (cancelled.job, false));
    let moved_up = rig.get(next.id).await.unwrap();
    assert_eq!(moved_up.queue_position, Some(1));
    assert!(moved_up.revision > next.revision);
    let claim = rig.claim_one(&owner("a")).await.unwrap();
    assert_eq!(claim.job.id, next.id);
    let gone = rig
        .store
        .cancel(&rig.tenant, JobId::random())
        .await
        .unwrap();
    assert_eq!(gone, None);
}

pub async fn cancelling_a_running_job_is_heard_with_the_beat(rig: Rig) {
    rig.accepted("{}").await;
    let claim = rig.claim_one(&owner("a")).await.unwrap();
    let id = claim.job.id;
    let marked = rig.store.cancel(&rig.tenant, id).await.unwrap().unwrap();
    assert!(marked.changed && marked.job.cancel_requested);
    assert_eq!(marked.job.status, Status::Running);
    let again = rig.store.cancel(&rig.tenant, id).await.unwrap().unwrap();
    assert!(!again.changed);
    let beat = beat_of(&claim, "a", 1.0, 1);
    let pulses = rig.store.beat(vec![beat], LEASE).await.unwrap();
    assert_eq!(pulses, [Pulse::CancelRequested]);
    let ended = rig
        .store
        .complete(fence(&claim, "a"), end(Outcome::Dismissed));
    let ended = ended.await.unwrap().unwrap();
    assert_eq!(ended.status, Status::Dismissed);
    assert!(!ended.cancel_requested);
}

pub async fn a_cancelled_job_whose_worker_is_lost_is_dismissed(rig: Rig) {
    let job = rig.accepted("{}").await;
    rig.claim_one(&owner("a")).await.unwrap();
    rig.store.cancel(&rig.tenant, job.id).await.unwrap();
    rig.clock.advance(LEASE);
    let changed = rig.store.reap(MAX_LOST).await.unwrap();
    assert_eq!(changed[0].status, Status::Dismissed);
    assert_eq!(rig.claim_one(&owner("b")).await, None);
}

pub async fn deleting_erases_whatever_the_state(rig: Rig) {
    let ended = rig.run_to(successful("{}")).await;
    let running = rig.accepted("1").await;
    let claim = rig.claim_one(&owner("a")).await.unwrap();
    assert_eq!(claim.job.id, running.id);
    let waiting = rig.accepted("2").await;
    for id in [ended.id, running.id, waiting.id] {
        assert!(rig.store.delete(&rig.tenant, id).await.unwrap());
        assert_eq!(rig.get(id).await, None);
        let looked = rig.store.blob(&rig.tenant, id, BlobKind::Input).await;
        assert_eq!(looked.unwrap(), None);
        assert!(!rig.store.delete(&rig.tenant, id).await.unwrap());
    }
    assert_eq!(rig.store.state().backlog, Backlog::default());
    let late = rig
        .store
        .complete(fence(&claim, "a"), end(successful("late")));
    assert_eq!(late.await.unwrap(), None);
    assert_eq!(rig.get(running.id).await, None);
}

pub async fn a_list_is_newest_first_and_complete(rig: Rig) {
    let mut ids = Vec::new();
    for n in 0..7 {
        // Two by two in the same millisecond.
        rig.clock.advance(Duration::from_millis(n % 2));
        ids.push(rig.accepted(&n.to_string()).await.id);
    }
    let mut found = Vec::new();
    let mut query = ListQuery {
        limit: 3,
        ..ListQuery::default()
    };
    loop {
        let page = rig.page(query.clone()).await;
        found.extend(page.items);
        // What comes in between is newer and not on later pages.
        rig.clock.advance(Duration::from_millis(5));
        rig.accepted("later").await;
        match page.next_cursor {
            Some(cursor) => query.cursor = Some(cursor),
            None => break,
        }
    }
    assert!(found.is_sorted_by(|a, b| (a.created, a.id) > (b.created, b.id)));
    let mut listed: Vec<JobId> = found.iter().map(|job| job.id).collect();
    listed.sort_unstable();
    ids.sort_unstable();
    assert_eq!(listed, ids);
    let places: Vec<_> = found.iter().filter_map(|j| j.queue_position).collect();
    assert_eq!(places.len(), 7, "each waiting job has its place");
}

pub async fn a_list_keeps_to_its_filters(rig: Rig) {
    let ended = rig.run_to(successful("{}")).await;
    let other = NewJob {
        method: "fairing".to_owned(),
        label: None,
        ..new_job("2")
    };
    let Admission::New(fairing) = rig.submit(other).await else {
        panic!("not new");
    };
    let ids = |page: Page| page.items.iter().map(|j| j.id).collect::<Vec<_>>();
    let all = ListQuery {
        limit: 50,
        ..ListQuery::default()
    };
    let by_status = ListQuery {
        status: Some(Status::Successful),
        ..all.clone()
    };
    assert_eq!(ids(rig.page(by_status.clone()).await), [ended.id]);
    let by_method = ListQuery {
        method: Some("fairing".to_owned()),
        ..all.clone()
    };
    assert_eq!(ids(rig.page(by_method).await), [fairing.id]);
    let by_label = ListQuery {
        label: Some("trawler".to_owned()),
        ..all.clone()
    };
    assert_eq!(ids(rig.page(by_label).await), [ended.id]);
    let both = ListQuery {
        method: Some("fairing".to_owned()),
        ..by_status
    };
    assert_eq!(rig.page(both).await.items, []);
    let bad = ListQuery {
        cursor: Some("1 OR 1=1".to_owned()),
        ..all
    };
    assert_eq!(rig.store.list(&rig.tenant, bad).await.unwrap(), None);
}

pub async fn what_is_past_its_time_is_erased(rig: Rig) {
    let keep = Retention {
        blobs: 2 * HOUR,
        records: 5 * HOUR,
        keys: HOUR,
    };
    let ended = rig.run_to(successful("{}")).await;
    rig.submit(keyed("waiting", "k", "b")).await;
    let sweep = || async { rig.store.sweep(keep).await.unwrap() };
    assert_eq!(sweep().await, Swept::default());

    rig.clock.advance(2 * HOUR + Duration::from_millis(1));
    let swept = Swept {
        blobs: 1,
        records: 0,
        keys: 1,
    };
    assert_eq!(sweep().await, swept);
    assert_eq!(sweep().await, Swept::default());
    for kind in [BlobKind::Input, BlobKind::Result, BlobKind::Diagnostics] {
        let looked = rig.store.blob(&rig.tenant, ended.id, kind).await.unwrap();
        let looked = looked.unwrap();
        assert_eq!((looked.blob, looked.erased), (None, true));
    }
    assert_eq!(rig.get(ended.id).await.unwrap().status, Status::Successful);

    rig.clock.advance(3 * HOUR);
    assert_eq!(sweep().await.records, 1);
    assert_eq!(rig.get(ended.id).await, None);
    let waiting = rig.claim_one(&owner("a")).await.unwrap();
    assert_eq!(waiting.input.unwrap(), "waiting", "active jobs are kept");
}

pub async fn a_sweep_does_a_bounded_amount(rig: Rig) {
    let many = Swept::AT_MOST + 10;
    for n in 0..many {
        let Admission::New(job) = rig.submit(keyed("{}", &n.to_string(), "b")).await else {
            panic!("not new");
        };
        rig.store.cancel(&rig.tenant, job.id).await.unwrap();
    }
    rig.clock.advance(DAY);
    let keep = Retention {
        blobs: HOUR,
        records: HOUR,
        keys: HOUR,
    };
    let first = rig.store.sweep(keep).await.unwrap();
    assert!(first.is_cut_short() && first.records == Swept::AT_MOST);
    let second = rig.store.sweep(keep).await.unwrap();
    assert_eq!((second.records, second.is_cut_short()), (10, false));
}
