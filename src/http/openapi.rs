//! The OpenAPI document: what is common to all paths, and the problem
//! documents of each, out of the same [`Code`] that picks the status.

use super::examples::EXAMPLES;
use super::problem::{Code, PROBLEM_JSON, Problem};
use std::collections::BTreeMap;
use utoipa::openapi::example::ExampleBuilder;
use utoipa::openapi::path::{Operation, PathItem};
use utoipa::openapi::response::{Response, ResponseBuilder};
use utoipa::openapi::schema::{KnownFormat, ObjectBuilder, Schema, SchemaFormat, SchemaType, Type};
use utoipa::openapi::{Content, HeaderBuilder, OpenApi, Ref, RefOr};
use utoipa::{IntoResponses, OpenApi as _, PartialSchema, ToSchema};

/// What stands above the paths.
#[derive(utoipa::OpenApi)]
#[openapi(
    info(
        title = "mouldloft",
        description = "Surface fitting for shipyards. Post the profile curves of a hull; get \
                       B-spline plates that can be bent from flat steel, with the figures that \
                       prove it. Post measured offsets; get fair lines and surfaces, with the \
                       table of corrections.\n\nErrors are problem documents (RFC 9457). Unknown fields and \
                       unknown query parameters are refused. Every answer carries `X-Request-Id`.",
        license(name = "MIT OR Apache-2.0"),
    ),
    components(schemas(Problem)),
    tags(
        (name = "jobs", description = "Submit, follow and end jobs"),
        (name = "results", description = "What jobs leave"),
        (name = "methods", description = "What can be fitted, and ready-to-post jobs"),
        (name = "checks", description = "Measure surfaces, whoever made them"),
        (name = "service", description = "Health, figures, this document"),
    ),
)]
struct Head;

/// The document before the paths are added.
#[must_use]
pub fn head() -> OpenApi {
    let mut api = Head::openapi();
    // The package's authors are not the interface's.
    api.info.contact = None;
    api
}

/// The document once all paths are in: adds HEAD where a file is given and the
/// header that every answer has, and moves the problem answers, of which most
/// paths share most, to the components.
pub fn finish(api: &mut OpenApi) {
    let mut shared = BTreeMap::new();
    for (path, item) in &mut api.paths.paths {
        if path.contains("/result.") || path.contains("/artifacts/") {
            item.head = item.get.as_ref().map(head_of);
        }
        for operation in operations(item) {
            for response in operation.responses.responses.values_mut() {
                let RefOr::T(plain) = response else { continue };
                plain.headers.insert(
                    "X-Request-Id".into(),
                    text_header("Names the request in the log.").into(),
                );
                if plain.content.contains_key(PROBLEM_JSON) {
                    let name = problem_name(&plain.description);
                    let reference = Ref::from_response_name(name.clone());
                    shared.insert(name, std::mem::replace(response, reference.into()));
                }
            }
        }
    }
    if let Some(components) = api.components.as_mut() {
        components.responses.extend(shared);
    }
    add_examples(api);
}

/// Jobs to try, at the submission: a small one and a real hull.
fn add_examples(api: &mut OpenApi) {
    /// The small one first: it is what the page shows.
    const SHOWN: [&str; 2] = ["punt", "trawler"];
    let submit = api
        .paths
        .paths
        .get_mut("/v1/jobs")
        .and_then(|item| item.post.as_mut());
    let body = submit.and_then(|post| post.request_body.as_mut());
    let Some(RefOr::T(body)) = body else { return };
    let Some(RefOr::T(content)) = body.content.get_mut("application/json") else {
        return;
    };
    for name in SHOWN {
        let Some(example) = EXAMPLES.iter().find(|e| e.name == name) else {
            continue;
        };
        let value = serde_json::from_str(example.body).unwrap_or_default();
        let shown = ExampleBuilder::new()
            .summary(example.description)
            .value(Some(value));
        content
            .examples
            .insert(name.to_owned(), shown.build().into());
    }
}

/// `JobNotFoundOrExpired` out of the codes that a description quotes.
fn problem_name(description: &str) -> String {
    let slugs = description.split('`').skip(1).step_by(2);
    let names = slugs.map(|slug| slug.split('-').map(capital).collect::<String>());
    names.collect::<Vec<_>>().join("Or")
}

fn capital(word: &str) -> String {
    let mut letters = word.chars();
    letters.next().map_or_else(String::new, |first| {
        first.to_ascii_uppercase().to_string() + letters.as_str()
    })
}

/// Bytes of any kind, for the document.
#[derive(Debug, Clone, Copy)]
pub struct RawBytes;

impl PartialSchema for RawBytes {
    fn schema() -> RefOr<Schema> {
        ObjectBuilder::new()
            .schema_type(Type::String)
            .format(Some(SchemaFormat::KnownFormat(KnownFormat::Binary)))
            .into()
    }
}

impl ToSchema for RawBytes {}

/// A file of any kind, for the document: some are JSON, and no string to those
/// who take them apart.
#[derive(Debug, Clone, Copy)]
pub struct AnyFile;

impl PartialSchema for AnyFile {
    fn schema() -> RefOr<Schema> {
        ObjectBuilder::new()
            .schema_type(SchemaType::AnyValue)
            .into()
    }
}

impl ToSchema for AnyFile {}

fn operations(item: &mut PathItem) -> impl Iterator<Item = &mut Operation> {
    [
        &mut item.get,
        &mut item.head,
        &mut item.post,
        &mut item.delete,
    ]
    .into_iter()
    .flatten()
}

fn head_of(get: &Operation) -> Operation {
    let mut head = get.clone();
    head.operation_id = head.operation_id.map(|id| format!("{id}_head"));
    head.summary = head.summary.map(|text| format!("{text} (headers alone)"));
    for response in head.responses.responses.values_mut() {
        if let RefOr::T(response) = response {
            response.content.clear();
        }
    }
    head
}

fn text_header(description: &str) -> utoipa::openapi::Header {
    HeaderBuilder::new()
        .schema(Some(ObjectBuilder::new().schema_type(Type::String)))
        .description(Some(description))
        .build()
}

/// The problem answers for some codes, one a status.
#[must_use]
pub fn problems(codes: &[Code]) -> BTreeMap<String, RefOr<Response>> {
    let mut texts: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for code in codes {
        let text = format!("`{}`: {}.", code.slug(), code.title());
        texts
            .entry(code.status().as_u16().to_string())
            .or_default()
            .push(text);
    }
    let retry = "Seconds after which to try again.";
    texts
        .into_iter()
        .map(|(status, lines)| {
            let content = Content::new(Some(Ref::from_schema_name("Problem")));
            let mut response = ResponseBuilder::new()
                .description(lines.join(" "))
                .content(PROBLEM_JSON, content);
            if matches!(status.as_str(), "409" | "503") {
                response = response.header("Retry-After", text_header(retry));
            }
            (status, response.build().into())
        })
        .collect()
}

macro_rules! problem_sets {
    ($( $(#[$doc:meta])* $name:ident = [$($code:ident),* $(,)?]; )*) => {
        $(
            $(#[$doc])*
            #[derive(Debug, Clone, Copy)]
            pub struct $name;

            impl IntoResponses for $name {
                fn responses() -> BTreeMap<String, RefOr<Response>> {
                    problems(&[
                        Code::InvalidQuery, Code::TooLarge, Code::UnsupportedMediaType,
                        Code::Internal, Code::Timeout, $(Code::$code,)*
                    ])
                }
            }
        )*
    };
}

problem_sets! {
    /// What can go wrong at every path.
    Everywhere = [];
    /// What can go wrong when a job is submitted.
    Submitting = [
        Syntax, InvalidHeader, BodyTimeout, InvalidJob, KeyReused,
        QueueFull, StorageFull, Draining, StoreUnavailable,
    ];
    /// What can go wrong when surfaces are measured.
    Verifying = [Syntax, BodyTimeout, InvalidSurfaces];
    /// What can go wrong when jobs are listed.
    Listing = [StoreUnavailable];
    /// What can go wrong with one job.
    OneJob = [JobNotFound, StoreUnavailable];
    /// What can go wrong when a job is ended by its owner.
    Ending = [JobNotFound, StoreUnavailable, StorageFull];
    /// What can go wrong with a job's input.
    Inputs = [JobNotFound, Expired, StoreUnavailable];
    /// What can go wrong with diagnostics.
    Diagnosing = [JobNotFound, NotStarted, Expired, StoreUnavailable];
    /// What can go wrong with a result.
    Results = [
        JobNotFound, NotAcceptable, ResultNotReady, JobFailed, JobDismissed, Expired,
        RangeNotSatisfiable, StoreUnavailable,
    ];
    /// What can go wrong with a result as a file.
    Files = [
        JobNotFound, FormatNotAvailable, ResultNotReady, JobFailed, JobDismissed, Expired,
        RangeNotSatisfiable, StoreUnavailable,
    ];
    /// What can go wrong with the list of a job's files.
    Artifacts = [
        JobNotFound, ResultNotReady, JobFailed, JobDismissed, Expired, StoreUnavailable,
    ];
    /// What can go wrong with one of them.
    OneArtifact = [
        JobNotFound, ArtifactNotFound, FormatNotAvailable, ResultNotReady, JobFailed,
        JobDismissed, Expired, RangeNotSatisfiable, StoreUnavailable,
    ];
    /// What can go wrong with one method.
    OneMethod = [MethodNotFound];
    /// What can go wrong with one example.
    OneExample = [ExampleNotFound];
    /// What can go wrong with a file of the documentation page.
    DocFiles = [NotFound];
    /// Why the service is not ready.
    Readiness = [NotReady];
}
