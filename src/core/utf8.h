// The bytes of texts in UTF-8.
#ifndef LACUNA_CORE_UTF8_H_
#define LACUNA_CORE_UTF8_H_

namespace lacuna {

// Whether `byte` is a byte of a character other than the first one.
inline bool ContinuesCharacter(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0) == 0x80;
}

}  // namespace lacuna

#endif  // LACUNA_CORE_UTF8_H_
