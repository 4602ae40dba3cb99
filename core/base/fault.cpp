#include "core/base/fault.h"

namespace relight {

std::string_view fault_code(Fault fault)
{
    switch (fault) {
        case Fault::MalformedJson:
            return "malformed_json";
        case Fault::JsonTooDeep:
            return "json_too_deep";
        case Fault::DuplicateField:
            return "duplicate_field";
        case Fault::UnknownField:
            return "unknown_field";
        case Fault::MissingField:
            return "missing_field";
        case Fault::WrongType:
            return "wrong_type";
        case Fault::OutOfRange:
            return "out_of_range";
        case Fault::WrongLength:
            return "wrong_length";
        case Fault::NotFinite:
            return "not_finite";
        case Fault::ZeroDirection:
            return "zero_direction";
        case Fault::ConflictingFields:
            return "conflicting_fields";
        case Fault::MixedUnits:
            return "mixed_units";
        case Fault::UnknownValue:
            return "unknown_value";
        case Fault::NotAvailable:
            return "not_available";
        case Fault::EmptyFile:
            return "empty_file";
        case Fault::UnknownFormat:
            return "unknown_format";
        case Fault::MalformedHeader:
            return "malformed_header";
        case Fault::MalformedBody:
            return "malformed_body";
        case Fault::Truncated:
            return "truncated";
        case Fault::CountExceedsFile:
            return "count_exceeds_file";
        case Fault::IndexOutOfRange:
            return "index_out_of_range";
        case Fault::NonFiniteCoordinate:
            return "non_finite_coordinate";
        case Fault::CoordinateTooLarge:
            return "coordinate_too_large";
        case Fault::NoGeometry:
            return "no_geometry";
        case Fault::NormalsRequired:
            return "normals_required";
        case Fault::ImportFailed:
            return "import_failed";
        case Fault::TooManyVertices:
            return "too_many_vertices";
        case Fault::TooManyFaces:
            return "too_many_faces";
        case Fault::BodyTooLarge:
            return "body_too_large";
        case Fault::UnsupportedMediaType:
            return "unsupported_media_type";
        case Fault::UnsupportedEncoding:
            return "unsupported_encoding";
        case Fault::NotAcceptable:
            return "not_acceptable";
        case Fault::NotFound:
            return "not_found";
        case Fault::MethodNotAllowed:
            return "method_not_allowed";
        case Fault::LengthRequired:
            return "length_required";
        case Fault::BadRequest:
            return "bad_request";
        case Fault::HeadTooLarge:
            return "head_too_large";
        case Fault::RequestTimeout:
            return "request_timeout";
        case Fault::Overloaded:
            return "overloaded";
        case Fault::Stopping:
            return "stopping";
        case Fault::Cancelled:
            return "cancelled";
        case Fault::Superseded:
            return "superseded";
        case Fault::Internal:
            return "internal";
    }
    return "internal";
}

}  // namespace relight
