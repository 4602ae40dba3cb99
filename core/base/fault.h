#pragma once

#include <string_view>

namespace relight {

/// What a caller got wrong. Each has a stable code in answers (`fault_code`) and, in
/// server/problem.cpp, a status and a title. Add here, in fault.cpp and there; nowhere else.
enum class Fault {
    // the request's fields
    MalformedJson,      // not JSON
    JsonTooDeep,        // deeper than 32
    DuplicateField,     // the same key twice in one object
    UnknownField,       // a key we do not know
    MissingField,       // a key we need
    WrongType,          // a string where a number belongs
    OutOfRange,         // a number outside what is allowed
    WrongLength,        // an array of another length
    NotFinite,          // NaN or infinity
    ZeroDirection,      // a direction of length zero
    ConflictingFields,  // two of which only one may stand
    MixedUnits,         // watts beside lumens
    UnknownValue,       // a word that is not among those allowed
    NotAvailable,       // in the contract, not in this build
    // a file
    EmptyFile,
    UnknownFormat,  // neither named nor recognised
    MalformedHeader,
    MalformedBody,     // a line or record that is not what the format says
    Truncated,         // ends before what it announces
    CountExceedsFile,  // announces more than its bytes can hold
    IndexOutOfRange,   // a face names a vertex that is not there
    NonFiniteCoordinate,
    CoordinateTooLarge,  // beyond what single-precision rays can carry
    NoGeometry,          // no vertices, or nothing that can be lit
    NormalsRequired,     // a cloud without normals
    ImportFailed,        // the import process broke on it, or ran over its limits
    // limits and the connection
    TooManyVertices,
    TooManyFaces,
    BodyTooLarge,
    UnsupportedMediaType,
    UnsupportedEncoding,
    NotAcceptable,
    NotFound,
    MethodNotAllowed,
    LengthRequired,
    BadRequest,  // HTTP framing we refuse
    HeadTooLarge,
    RequestTimeout,
    Overloaded,
    Stopping,
    Cancelled,
    Superseded,  // a newer request of its session took its place
    Internal,
};

/// The stable snake_case code of a fault: "index_out_of_range".
std::string_view fault_code(Fault fault);

}  // namespace relight
