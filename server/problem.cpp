#include "server/problem.h"

#include "server/json_text.h"

namespace relight {

ProblemKind problem_kind(Fault fault)
{
    switch (fault) {
        case Fault::MalformedJson:
            return {400, "The request is not JSON"};
        case Fault::JsonTooDeep:
            return {422, "The JSON is nested too deeply"};
        case Fault::DuplicateField:
            return {422, "A field stands twice"};
        case Fault::UnknownField:
            return {422, "A field is not known"};
        case Fault::MissingField:
            return {422, "A field is missing"};
        case Fault::WrongType:
            return {422, "A value is of the wrong type"};
        case Fault::OutOfRange:
            return {422, "A value is out of range"};
        case Fault::WrongLength:
            return {422, "An array has the wrong length"};
        case Fault::NotFinite:
            return {422, "A number is not finite"};
        case Fault::ZeroDirection:
            return {422, "A direction has no length"};
        case Fault::ConflictingFields:
            return {422, "Fields exclude each other"};
        case Fault::MixedUnits:
            return {422, "Watts and lumens are mixed"};
        case Fault::UnknownValue:
            return {422, "A word is not among those allowed"};
        case Fault::NotAvailable:
            return {422, "This build does not have that yet"};
        case Fault::EmptyFile:
            return {422, "The file is empty"};
        case Fault::UnknownFormat:
            return {415, "The file's format is not recognised"};
        case Fault::MalformedHeader:
            return {422, "The file's header is malformed"};
        case Fault::MalformedBody:
            return {422, "The file is malformed"};
        case Fault::Truncated:
            return {422, "The file ends too early"};
        case Fault::CountExceedsFile:
            return {422, "The file announces more than it holds"};
        case Fault::IndexOutOfRange:
            return {422, "A face names a vertex that is not there"};
        case Fault::NonFiniteCoordinate:
            return {422, "A coordinate is not finite"};
        case Fault::CoordinateTooLarge:
            return {422, "A coordinate is too large"};
        case Fault::NoGeometry:
            return {422, "There is nothing to light"};
        case Fault::NormalsRequired:
            return {422, "A point cloud needs normals"};
        case Fault::ImportFailed:
            return {422, "The file could not be imported"};
        case Fault::TooManyVertices:
            return {413, "Too many vertices"};
        case Fault::TooManyFaces:
            return {413, "Too many faces"};
        case Fault::BodyTooLarge:
            return {413, "The body is too large"};
        case Fault::UnsupportedMediaType:
            return {415, "The media type is not supported"};
        case Fault::UnsupportedEncoding:
            return {415, "The content encoding is not supported"};
        case Fault::NotAcceptable:
            return {406, "No format the client accepts"};
        case Fault::NotFound:
            return {404, "Not found"};
        case Fault::MethodNotAllowed:
            return {405, "The method is not allowed here"};
        case Fault::LengthRequired:
            return {411, "A length is required"};
        case Fault::BadRequest:
            return {400, "Bad request"};
        case Fault::HeadTooLarge:
            return {431, "The request's head is too large"};
        case Fault::RequestTimeout:
            return {408, "The request took too long to arrive"};
        case Fault::Overloaded:
            return {503, "The server is busy"};
        case Fault::Stopping:
            return {503, "The server is stopping"};
        case Fault::Cancelled:
            return {503, "The work was stopped"};
        case Fault::Superseded:
            return {409, "A newer request took its place"};
        case Fault::Internal:
            return {500, "Internal error"};
    }
    return {500, "Internal error"};
}

std::string problem_json(const Error& error, int status)
{
    const ProblemKind kind = problem_kind(error.fault);
    const std::string code(fault_code(error.fault));
    ObjectWriter json;
    json.text("type", "/problems/" + code)
        .text("title", kind.title)
        .count("status", static_cast<std::uint64_t>(status == 0 ? kind.status : status))
        .text("detail", error.detail)
        .text("code", code);
    if (error.line) {
        json.count("line", *error.line);
    } else if (error.byte) {
        json.count("byte", *error.byte);
    } else if (!error.pointer.empty()) {
        json.text("pointer", error.pointer);
    }
    return json.done();
}

}  // namespace relight
