// What a shared library shows of itself: everything else is compiled with hidden visibility.
#pragma once

#if defined(__GNUC__)
#define ISOCHOR_API __attribute__((visibility("default")))
#else
#define ISOCHOR_API
#endif
