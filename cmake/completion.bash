# Bash completion of Fathom's programs. What follows this file is written by the programs themselves (--pages):
#   _fathom_words[PROGRAM or PROGRAM SUBCOMMAND]   subcommands, choices and options
#   _fathom_values[... OPTION]                     set where the option takes a value: the choices, empty for a file or number
declare -gA _fathom_words=() _fathom_values=()

_fathom() {
  local current=${COMP_WORDS[COMP_CWORD]} command=${COMP_WORDS[0]##*/} option= word position
  if ((COMP_CWORD > 1)); then
    word="$command ${COMP_WORDS[1]}"
    [[ ${_fathom_words[$word]+known} ]] && command=$word
  fi
  for ((position = COMP_CWORD - 1; position > 0; --position)); do
    if [[ ${COMP_WORDS[position]} == -* ]]; then
      option="$command ${COMP_WORDS[position]}"
      break
    fi
  done

  COMPREPLY=()
  local words=
  if [[ $current == -* ]]; then
    words=${_fathom_words[$command]}
  elif [[ $option && ${_fathom_values[$option]+known} ]]; then
    ((position == COMP_CWORD - 1)) && words=${_fathom_values[$option]}
  else
    for word in ${_fathom_words[$command]}; do [[ $word == -* ]] || words+=" $word"; done
  fi
  if [[ $words ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$current")
  else
    compopt -o filenames 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -f -- "$current")
  fi
}
