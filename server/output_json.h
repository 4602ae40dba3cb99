#pragma once

#include "server/fields.h"
#include "server/request.h"

namespace relight {

/// "display" of the request: from radiance to color.
Display parse_display(Fields fields);

/// "output" of the request: how the answer is written.
Output parse_output(Fields fields, const ParseLimits& limits);

/// "irradiance:float16,color" of ?fields=: arrays and their types; float32 if none is named, of
/// color uint8. Says in `output` what is to be computed for them. Errors: UnknownValue,
/// DuplicateField, ConflictingFields if the request names a format or quantities.
std::optional<Error> parse_fields_query(std::string_view text, Output& output);

}  // namespace relight
