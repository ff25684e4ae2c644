// Which sanitizers this is compiled with: GCC tells by macros, clang by features.
#pragma once

#ifdef __has_feature
#define LODESTONE_HAS_FEATURE(name) __has_feature(name)
#else
#define LODESTONE_HAS_FEATURE(name) 0
#endif

#if defined(__SANITIZE_ADDRESS__) || LODESTONE_HAS_FEATURE(address_sanitizer)
#define LODESTONE_ADDRESS_SANITIZER 1
#else
#define LODESTONE_ADDRESS_SANITIZER 0
#endif

#if defined(__SANITIZE_THREAD__) || LODESTONE_HAS_FEATURE(thread_sanitizer)
#define LODESTONE_THREAD_SANITIZER 1
#else
#define LODESTONE_THREAD_SANITIZER 0
#endif
