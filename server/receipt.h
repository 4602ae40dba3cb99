#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "server/multipart.h"
#include "server/relight.h"
#include "server/request.h"

namespace relight {

/// SHA-256 of all that an answer depends on: the request in a canonical form, the files that came
/// with it (files it names by id are named by their content), how it is answered (`query`: what
/// stands after '?'), this build and its instruction set. The same bytes answer the same digest.
/// `json` has been parsed well.
std::string request_digest(std::string_view json, const std::vector<Part>& parts, Format format,
                           std::string_view query);

/// What a result can be checked by: hashes of the request (request_digest()), of the mesh and of
/// the result, seed and samples, units, versions.
struct Receipt {
    std::string inputs, settings;  ///< the members before and behind the result's hash

    std::string json(std::string_view result_sha256) const;
};
Receipt receipt_of(const RelightRequest& request, const std::vector<Part>& parts, Units units,
                   std::string_view digest);

std::string sha256(const Encoding& body);

/// A JSON answer with its receipt as its last member; the result's hash is made on the way.
Encoding with_receipt(Encoding json, Receipt receipt);

/// Whether an If-None-Match header (RFC 9110, 13.1.2) names this entity tag.
bool names_tag(std::string_view header, std::string_view tag);

}  // namespace relight
