# Makes a C++ source that holds the text of SCRIPT (empty if there is no such file).
set(text "")
if(SCRIPT)
  file(READ "${SCRIPT}" text)
endif()
file(WRITE "${OUTPUT}" "#include \"tools/viewer.hpp\"

namespace crosspatch {

std::string_view viewer_script() {
  static constexpr char kText[] = R\"CROSSPATCH(${text})CROSSPATCH\";
  return {kText, sizeof kText - 1};
}

}  // namespace crosspatch
")
