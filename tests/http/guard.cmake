# The guarded connection alone: a tiny server for test_hostile.py, and the head parser's facts.
find_package(ZLIB REQUIRED)
add_executable(guard_echo ${CMAKE_CURRENT_LIST_DIR}/guard_echo.cpp)
target_link_libraries(guard_echo PRIVATE relight::guard ZLIB::ZLIB)

relight_test(http_head_test
    SOURCES ${CMAKE_CURRENT_LIST_DIR}/http_head_test.cpp
    USES    relight::guard)

add_test(NAME hostile_guard_echo
    COMMAND /usr/bin/python3 -m pytest -q -p no:cacheprovider
            ${CMAKE_CURRENT_LIST_DIR}/test_hostile.py)
set_tests_properties(hostile_guard_echo PROPERTIES
    TIMEOUT 300 ENVIRONMENT "RELIGHTD=$<TARGET_FILE:guard_echo>;PYTHONDONTWRITEBYTECODE=1")
