# Included by the project in the preset coverage: a process that ends by _exit writes its counts as well.
file(WRITE ${PROJECT_BINARY_DIR}/coverage_exit.c
"#include <sys/syscall.h>
#include <unistd.h>
void __gcov_dump(void);
void _exit(int status)
{
    __gcov_dump();
    syscall(SYS_exit_group, status);
    __builtin_unreachable();
}
")
add_library(plumb_coverage_exit OBJECT ${PROJECT_BINARY_DIR}/coverage_exit.c)
set_target_properties(plumb_coverage_exit PROPERTIES C_STANDARD 17 C_EXTENSIONS ON)
link_libraries($<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:$<TARGET_OBJECTS:plumb_coverage_exit>>)
