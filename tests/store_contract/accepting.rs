//! Accepting: keys, limits, inputs.

use super::rig::*;

pub async fn an_accepted_job_is_there_with_all_it_was_given(rig: Rig) {
    let job = rig.accepted("{\"hull\": 1}\n").await;
    assert_eq!(rig.get(job.id).await.unwrap(), job);
    assert_eq!(job.status, Status::Accepted);
    assert_eq!((job.attempt, job.progress), (0, 0.0));
    assert_eq!(job.queue_position, Some(1));
    assert_eq!(job.created, rig.clock.now());
    assert_eq!(job.label.as_deref(), Some("trawler"));
    assert_eq!(job.warnings, ["one \"quoted\" line"]);
    assert_eq!(job.input_bytes, 12);
    let input = rig.blob(job.id, BlobKind::Input).await;
    assert_eq!(input.unwrap(), "{\"hull\": 1}\n");
    assert_eq!(rig.blob(job.id, BlobKind::Result).await, None);
}

pub async fn the_same_key_and_body_give_the_same_job(rig: Rig) {
    let Admission::New(job) = rig.submit(keyed("{}", "k", "body")).await else {
        panic!("not new");
    };
    let again = rig.submit(keyed("{}", "k", "body")).await;
    assert_eq!(again, Admission::Replayed(job.clone()));
    let other = rig.submit(keyed("{}", "k", "another body")).await;
    assert_eq!(other, Admission::KeyConflict);
    assert_eq!(rig.store.state().backlog.queued, 1);

    let key = keyed("{}", "k", "body").idempotency.unwrap();
    let known = rig.store.replay(&rig.tenant, &key, DAY).await.unwrap();
    assert_eq!(known, Some(Admission::Replayed(job)));
    let theirs = Tenant::new("other");
    assert_eq!(rig.store.replay(&theirs, &key, DAY).await.unwrap(), None);
    let theirs = rig
        .store
        .accept(&theirs, keyed("{}", "k", "x"), ROOMY)
        .await;
    assert!(matches!(theirs.unwrap(), Admission::New(_)));
}

pub async fn a_key_is_forgotten_in_time_and_with_its_job(rig: Rig) {
    let Admission::New(first) = rig.submit(keyed("{}", "k", "body")).await else {
        panic!("not new");
    };
    rig.clock.advance(DAY + Duration::from_millis(1));
    let Admission::New(second) = rig.submit(keyed("{}", "k", "other")).await else {
        panic!("the key should be forgotten");
    };
    assert_ne!(first.id, second.id);
    assert!(rig.store.delete(&rig.tenant, second.id).await.unwrap());
    let third = rig.submit(keyed("{}", "k", "third")).await;
    assert!(matches!(third, Admission::New(_)));
}

pub async fn limits_turn_away_by_count_and_by_bytes(rig: Rig) {
    let narrow = Limits {
        jobs: 2,
        bytes: 10,
        ..ROOMY
    };
    let submit = |text: &str| rig.store.accept(&rig.tenant, new_job(text), narrow);
    let long = submit("12345678901").await.unwrap();
    assert_eq!(long, Admission::QueueFull);
    assert!(matches!(
        submit("1234567").await.unwrap(),
        Admission::New(_)
    ));
    assert_eq!(submit("1234").await.unwrap(), Admission::QueueFull);
    assert!(matches!(submit("123").await.unwrap(), Admission::New(_)));
    assert_eq!(submit("").await.unwrap(), Admission::QueueFull);
    assert_eq!(rig.store.state().backlog.queued_bytes, 10);
    // A job that has begun makes room.
    rig.claim_one(&owner("a")).await.unwrap();
    assert!(matches!(submit("1").await.unwrap(), Admission::New(_)));
    let backlog = Backlog {
        queued: 2,
        queued_bytes: 4,
        running: 1,
    };
    assert_eq!(rig.store.state().backlog, backlog);
}

pub async fn a_large_input_and_result_come_back_whole(rig: Rig) {
    let input: String = (0..90_000).map(|n| format!("{n},")).collect();
    let job = rig.accepted(&input).await;
    let claim = rig.claim_one(&owner("a")).await.unwrap();
    assert_eq!(claim.input.as_ref().unwrap(), &input);
    let ended = rig
        .store
        .complete(fence(&claim, "a"), end(successful(&input)));
    assert_eq!(
        ended.await.unwrap().unwrap().result_bytes,
        Some(input.len() as u64)
    );
    assert_eq!(rig.blob(job.id, BlobKind::Result).await.unwrap(), input);
    rig.store.probe().await.unwrap();
    assert!(rig.store.state().writable);
}
