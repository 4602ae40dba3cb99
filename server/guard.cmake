# The guarded connection: the one library of ours that knows cpp-httplib's classes.
find_package(PkgConfig REQUIRED)
# GLOBAL: tests link it too. Its -D flags are part of its ABI.
pkg_check_modules(httplib REQUIRED IMPORTED_TARGET GLOBAL cpp-httplib)

add_library(relight_guard STATIC
    ${CMAKE_CURRENT_LIST_DIR}/guard.cpp
    ${CMAKE_CURRENT_LIST_DIR}/guarded_body.cpp
    ${CMAKE_CURRENT_LIST_DIR}/guarded_stream.cpp
    ${CMAKE_CURRENT_LIST_DIR}/head_scanner.cpp
    ${CMAKE_CURRENT_LIST_DIR}/http_head.cpp
    ${CMAKE_CURRENT_LIST_DIR}/patience.cpp)
target_link_libraries(relight_guard PUBLIC relight_flags relight::base PkgConfig::httplib)
add_library(relight::guard ALIAS relight_guard)
