#include "core/file_lock.h"

#include <fcntl.h>

#include <cerrno>
#include <cstdio>

namespace lacuna {
namespace {

struct flock LockOnWholeFile() {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  return lock;
}

}  // namespace

bool LockFile(int descriptor, bool wait) {
  struct flock lock = LockOnWholeFile();
  int result = 0;
  do {
    result = fcntl(descriptor, wait ? F_OFD_SETLKW : F_OFD_SETLK, &lock);
  } while (result != 0 && errno == EINTR);
  return result == 0;
}

bool IsLockedByAnother(int descriptor) {
  struct flock lock = LockOnWholeFile();
  return fcntl(descriptor, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

}  // namespace lacuna
