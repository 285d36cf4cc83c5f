// SPDX-License-Identifier: MIT
// Defines __SANITIZE_ADDRESS__ and __SANITIZE_THREAD__ for sanitized builds. GCC defines them itself; clang
// before version 21 does not.
#pragma once

#ifdef __has_feature
#if __has_feature(address_sanitizer) && !defined(__SANITIZE_ADDRESS__)
#define __SANITIZE_ADDRESS__ 1
#endif
#if __has_feature(thread_sanitizer) && !defined(__SANITIZE_THREAD__)
#define __SANITIZE_THREAD__ 1
#endif
#endif
