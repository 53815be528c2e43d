# Completion of plumb in bash 4.4 or later. Source this file, or copy it to
# ~/.local/share/bash-completion/completions/plumb. plumb __complete finds the candidates.
_plumb() {
    local rest=${COMP_LINE:0:COMP_POINT} words=() i trimmed word line
    # Readline divides words also at '=' and ':'. Parts without a blank between them are one word.
    for ((i = 0; i <= COMP_CWORD; i++)); do
        trimmed=${rest#"${rest%%[![:blank:]]*}"}
        word=${COMP_WORDS[i]}
        ((i < COMP_CWORD)) || word=$trimmed
        if ((i == 0)) || [[ $trimmed != "$rest" ]]; then
            words+=("$word")
        else
            words[-1]+=$word
        fi
        rest=${trimmed#"$word"}
    done

    # Readline replaces what follows the last of its breaks; it does not break words in quotes.
    local current=${words[-1]} breaks=${COMP_WORDBREAKS//[^=:]/} lead='' option=''
    if [[ $current == [\'\"]* ]]; then
        current=${current:1}
    elif [[ -n $breaks && $current == *["$breaks"]* ]]; then
        lead=${current%"${current##*["$breaks"]}"}
    fi
    words[-1]=$current
    [[ $current == --*=* ]] && option=${current%%=*}=

    COMPREPLY=()
    while IFS= read -r line; do
        if [[ $line == ':files '* ]]; then
            compopt -o filenames
            while IFS= read -r word; do
                word=$option$word
                COMPREPLY+=("${word#"$lead"}")
            done < <(compgen -f -X "!*${line#:files }" -- "${current#"$option"}"
                     compgen -d -- "${current#"$option"}")
        else
            word=${line%%$'\t'*}
            COMPREPLY+=("${word#"$lead"}")
        fi
    done < <("${words[0]/#\~\//$HOME/}" __complete "${words[@]:1}" 2>/dev/null)
    [[ ${#COMPREPLY[@]} == 1 && ${COMPREPLY[0]} == *[=:,] ]] && compopt -o nospace
    return 0
}
complete -F _plumb plumb
