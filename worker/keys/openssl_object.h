// Owning pointers for OpenSSL's objects.
#pragma once

#include <openssl/bio.h>

#include <memory>
#include <string>

namespace penumbra {

template <auto kFree>
struct Freed {
  template <typename T>
  void operator()(T* object) const {
    kFree(object);
  }
};
using Bio = std::unique_ptr<BIO, Freed<BIO_free>>;

/// A reader of PEM text, which must outlive it.
inline Bio pem_reader(const std::string& pem) { return Bio(BIO_new_mem_buf(pem.data(), int(pem.size()))); }

}  // namespace penumbra
