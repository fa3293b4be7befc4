// Exceptions of the library in a module without exceptions: the host gets the message and throws it as its
// own error. Nothing is unwound, so the instance must not be used again; conelane.mjs starts another one.
#include "conelane/invalid_input.hpp"

#include <array>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <typeinfo>

namespace {

extern "C" __attribute__((import_module("conelane"), import_name("thrown"))) void conelane_thrown(
    const char* message);

/// Memory for exceptions; one is enough, since the first one ends the instance.
constexpr std::size_t kRoom = 1024;
alignas(std::max_align_t) std::array<std::byte, kRoom> room;

/// The message of an exception of exactly one of these types; nothing for any other.
template <class... Types>
const char* message_of(void* thrown, const std::type_info& type) {
    const char* message = nullptr;
    const auto look = [&]<class Type>(Type* value) {
        if (type == typeid(Type)) message = value->what();
    };
    (look(static_cast<Types*>(thrown)), ...);
    return message;
}

}  // namespace

extern "C" {

void* __cxa_allocate_exception(std::size_t size) noexcept {
    return size <= kRoom ? room.data() : std::malloc(size);
}

[[noreturn]] void __cxa_throw(void* thrown, std::type_info* type, void (*)(void*)) {
    const char* message =
        message_of<conelane::InvalidInput, std::invalid_argument, std::domain_error, std::length_error,
                   std::out_of_range, std::logic_error, std::runtime_error, std::bad_alloc>(thrown, *type);
    conelane_thrown(message != nullptr ? message : type->name());
    __builtin_trap();
}
}
